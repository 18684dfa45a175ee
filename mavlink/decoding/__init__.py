"""What MAVLink messages say, in the log's terms; and whose clock says when. Pure."""
