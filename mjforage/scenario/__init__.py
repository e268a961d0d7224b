"""The scenario: its file and schema, roles, maps, harbours and vessel files. No MuJoCo."""
