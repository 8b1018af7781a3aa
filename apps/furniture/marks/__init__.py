"""What a piece of furniture shows at the hand in live sessions."""
