"""Speed, as ratios against something else measured in the same run."""
