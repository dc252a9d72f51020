"""The session that all pages share: the trainee and the choices."""
