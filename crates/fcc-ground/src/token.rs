//! The token that permits changes: who has the link may use them.

use std::fmt;
use std::io::{self, ErrorKind};
use std::path::Path;

use axum::http::HeaderMap;
use axum::http::header::AUTHORIZATION;
use subtle::ConstantTimeEq as _;

use crate::files;

/// 128 random bits in hexadecimal.
#[derive(Clone)]
pub struct Token(String);

const BYTES: usize = 16;

impl Token {
    /// The token of this folder; made when there is none, or when another one is wanted.
    ///
    /// # Errors
    /// When the file can be neither read nor written.
    pub fn of(state: &Path, anew: bool) -> io::Result<Self> {
        let path = state.join("token");
        if !anew {
            match files::read_limited(&path, 1_024) {
                Ok(text) if is_token(text.trim()) => return Ok(Self(text.trim().to_owned())),
                Err(error) if error.kind() != ErrorKind::NotFound => return Err(error),
                _ => {}
            }
        }
        let mut bytes = [0_u8; BYTES];
        getrandom::fill(&mut bytes).map_err(io::Error::other)?;
        let text = format!("{:032x}", u128::from_be_bytes(bytes));
        files::replace(&path, text.as_bytes())?;
        Ok(Self(text))
    }

    /// Whether a request carries it. How long this takes does not tell how much of it is
    /// right.
    pub(crate) fn is_in(&self, headers: &HeaderMap) -> bool {
        let mut given = headers.get_all(AUTHORIZATION).iter();
        let (Some(one), None) = (given.next(), given.next()) else {
            return false;
        };
        let Some(given) = one.as_bytes().strip_prefix(b"Bearer ") else {
            return false;
        };
        self.is(given)
    }

    /// Whether this is it, as [`is_in`](Self::is_in).
    pub(crate) fn is(&self, given: &[u8]) -> bool {
        given.ct_eq(self.0.as_bytes()).into()
    }

    /// For the link.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl fmt::Debug for Token {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Token")
    }
}

fn is_token(text: &str) -> bool {
    text.len() == 2 * BYTES && text.bytes().all(|byte| byte.is_ascii_hexdigit())
}

#[cfg(test)]
mod tests {
    use std::os::unix::fs::PermissionsExt as _;

    use super::*;

    #[test]
    fn a_token_stays_until_another_one_is_wanted_and_is_its_users_alone() {
        let folder = tempfile::tempdir().unwrap();
        let first = Token::of(folder.path(), false).unwrap();
        assert_eq!(first.as_str().len(), 32);
        assert_eq!(Token::of(folder.path(), false).unwrap().0, first.0);
        let mode = folder
            .path()
            .join("token")
            .metadata()
            .unwrap()
            .permissions();
        assert_eq!(mode.mode() & 0o077, 0);
        assert_ne!(Token::of(folder.path(), true).unwrap().0, first.0);
    }

    #[test]
    fn a_file_that_has_no_token_permits_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let long = "0123456789abcdef0123456789abcdef0";
        for text in ["", "\n", "0", " 0123456789abcdef", long, &"z".repeat(32)] {
            std::fs::write(folder.path().join("token"), text).unwrap();
            let token = Token::of(folder.path(), false).unwrap();
            assert!(is_token(token.as_str()), "{text:?}");
            assert!(token.as_str() != text.trim(), "{text:?}");
        }
        std::fs::write(folder.path().join("token"), "0".repeat(2_000)).unwrap();
        assert!(Token::of(folder.path(), false).is_err());
    }

    #[test]
    fn only_the_whole_token_is_one() {
        let token = Token("0123456789abcdef0123456789abcdef".to_owned());
        let is_in = |value: &str| {
            let mut headers = HeaderMap::new();
            headers.insert(AUTHORIZATION, value.parse().unwrap());
            token.is_in(&headers)
        };
        assert!(is_in("Bearer 0123456789abcdef0123456789abcdef"));
        for wrong in [
            "Bearer 0123456789abcdef0123456789abcde",
            "Bearer 0123456789abcdef0123456789abcdef0",
            "Bearer ",
            "0123456789abcdef0123456789abcdef",
            "Basic 0123456789abcdef0123456789abcdef",
        ] {
            assert!(!is_in(wrong), "{wrong}");
        }
        assert!(!token.is_in(&HeaderMap::new()));
    }
}
