//! Input files in TOML: the place of every byte, and every mistake at once, each with its place, what was expected and what to do.

mod error;
mod text;

pub use error::{InputError, InputErrors, Mistakes, Place, Reason, Spot};
pub use text::{InputText, read_text};
