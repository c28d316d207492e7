"""What becomes of a fitted model: verdict, report, prediction of other recordings, rig file."""
