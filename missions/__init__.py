from missions import reasons as reasons
