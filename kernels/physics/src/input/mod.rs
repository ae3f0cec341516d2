//! Input files in TOML. All mistakes are reported at once, each with its location, the expected value and advice.

mod error;
mod text;

pub use error::{InputError, InputErrors, MistakeKind, MistakeList, Spot, TextLocation};
pub use text::{InputText, read_text};
