from inspection import reasons as reasons
