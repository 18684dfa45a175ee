from workspace import reasons as reasons
