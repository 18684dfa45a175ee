"""What later apps add: facts that missions ask for, without importing the apps."""
