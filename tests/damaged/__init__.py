"""Small files of every format, and seeded damage to them: no reader may crash, whatever comes."""
