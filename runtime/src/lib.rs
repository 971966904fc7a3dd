//! Runs: async tasks generic over device traits, latest-value signals and bounded queues, the same on every board.
#![no_std]
