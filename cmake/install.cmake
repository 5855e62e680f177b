# Filled in with the install rules: libraries, headers, package files.
