"""The compiled core of the planners: where it is kept, and how programs warm it up."""
