//! The graph as text, for people and tests.
