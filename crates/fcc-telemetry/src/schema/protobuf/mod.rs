//! A struct as a message of protobuf, and what describes such messages.
//!
//! A number keeps its bits: every `double` and every instant is written, 0 and
//! NaN too. A count, a code, a set of conditions or a `bool` that is 0 is left
//! out, as proto3 has it. What a message leaves out altogether decodes to the
//! default, so that fields may be added; a code that is not declared is refused.

mod decode;
mod describe;
mod encode;
mod model;
mod text;

pub use decode::{DecodeError, decode};
pub use describe::describe;
pub use encode::{append_text, encode};
pub use model::{Extra, FieldType, File, Message, MessageField};
pub use text::text;
