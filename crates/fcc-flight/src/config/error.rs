//! The errors of a configuration file, and where they are.

use std::fmt;
use std::io;
use std::str::Utf8Error;

use serde::Serialize;

/// The errors of a configuration file.
#[derive(Debug)]
#[non_exhaustive]
pub enum ConfigError {
    /// The file cannot be read.
    Unreadable {
        /// Its name.
        file: String,
        /// The reason.
        source: io::Error,
    },
    /// The file is invalid: each problem with its location.
    Invalid {
        /// Its name.
        file: String,
        /// At least one.
        problems: Vec<Problem>,
    },
}

/// One problem and its location.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct Problem {
    /// Line of the file, from 1; none for what is not in the file.
    pub line: Option<usize>,
    /// The key, with its sections: `autopilot.envelope.max_bank_deg`.
    pub key: Option<String>,
    /// What is wrong and what is permitted.
    pub message: String,
}

impl ConfigError {
    /// The file is not text.
    pub(super) fn not_text(file: &str, bytes: &[u8], error: Utf8Error) -> Self {
        let good = bytes.get(..error.valid_up_to()).unwrap_or_default();
        let line = good.split(|byte| *byte == b'\n').count();
        Self::Invalid {
            file: file.to_owned(),
            problems: vec![Problem {
                line: Some(line),
                key: None,
                message: "is not UTF-8: give a configuration, saved as UTF-8 text".to_owned(),
            }],
        }
    }

    /// The file is a flight plan.
    pub(super) fn a_plan(file: String) -> Self {
        Self::Invalid {
            file,
            problems: vec![Problem {
                line: None,
                key: None,
                message: "this is a flight plan: give it as [plan] file, or with --plan".to_owned(),
            }],
        }
    }

    /// The problems, for tools to read.
    pub fn problems(&self) -> Vec<Problem> {
        match self {
            Self::Unreadable { source, .. } => vec![Problem {
                line: None,
                key: None,
                message: unreadable(source),
            }],
            Self::Invalid { problems, .. } => problems.clone(),
        }
    }
}

/// The longest quotation from a file, in characters.
const LONGEST_KEY: usize = 200;
const LONGEST_MESSAGE: usize = 1_000;

impl Problem {
    /// That further problems were not looked for.
    pub(super) fn and_more() -> Self {
        Self {
            line: None,
            key: None,
            message: "has more problems: correct these first".to_owned(),
        }
    }

    /// Shortens what it quotes from the file.
    pub(super) fn shorten(&mut self) {
        for (text, most) in [
            (self.key.as_mut(), LONGEST_KEY),
            (Some(&mut self.message), LONGEST_MESSAGE),
        ] {
            if let Some(text) = text
                && let Some((end, _)) = text.char_indices().nth(most)
            {
                text.truncate(end);
                text.push('…');
            }
        }
    }

    /// Whether its key is in this section.
    pub(super) fn is_in(&self, section: &str) -> bool {
        let key = self.key.as_deref().unwrap_or_default();
        key.split('.').next() == Some(section)
    }
}

fn unreadable(source: &io::Error) -> String {
    format!(
        "cannot be read: {source}. Give the path of a configuration file; examples are in the \
         folder config/"
    )
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreadable { file, source } => write!(f, "{file}: {}", unreadable(source)),
            Self::Invalid { file, problems } => {
                for (n, problem) in problems.iter().enumerate() {
                    let separator = if n == 0 { "" } else { "\n" };
                    write!(f, "{separator}{file}")?;
                    if let Some(line) = problem.line {
                        write!(f, ":{line}")?;
                    }
                    if let Some(key) = &problem.key {
                        write!(f, ": {key}")?;
                    }
                    write!(f, ": {}", problem.message)?;
                }
                Ok(())
            }
        }
    }
}

impl std::error::Error for ConfigError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Unreadable { source, .. } => Some(source),
            Self::Invalid { .. } => None,
        }
    }
}
