//! Stripmine.
