"""What scenes and edit scripts of furniture hold."""
