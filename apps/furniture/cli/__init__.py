"""What commands print of furniture."""
