//! Protobuf messages of structs, and their description.
//!
//! Numbers keep their bits: every `double` and every instant is written, 0 and
//! NaN too. A count, a code, flags or a `bool` that is 0 is omitted, as in
//! proto3. A message that is missing decodes to the default, so that fields can
//! be added; an undeclared code is an error.

mod decode;
mod describe;
mod encode;
mod model;
mod rows;
mod text;

pub use decode::{DecodeError, decode};
pub use describe::describe;
pub use encode::{append_text, encode};
pub use model::{Extra, FieldType, File, Message, MessageField};
pub use rows::RowDecoder;
pub use text::text;
