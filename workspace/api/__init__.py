"""What every endpoint of the API shares: errors, paging, parsing, permissions, limits and the OpenAPI document."""
