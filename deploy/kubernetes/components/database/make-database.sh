#!/bin/bash
# Run once, by the first start on an empty disk: the program's own role is no superuser, so the extension is made here.
set -euo pipefail
psql --quiet --set=ON_ERROR_STOP=1 --username "$POSTGRES_USER" --set=password="$(cat /run/secrets/postgresql/spanwise-password)" <<'SQL'
CREATE ROLE spanwise LOGIN PASSWORD :'password';
CREATE DATABASE spanwise OWNER spanwise;
\connect spanwise
CREATE EXTENSION postgis;
SQL
