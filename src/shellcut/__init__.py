"""shellcut: a sharp rigid blade cuts a thin shell."""
