"""What is kept and when it is made again: choice of preconditioners by counted work, its prices, refreshes."""
