//! What is wrong with a configuration file, and where.

use std::fmt;
use std::ops::Range;

use serde::Serialize;

/// What is wrong with a configuration file.
#[derive(Debug)]
#[non_exhaustive]
pub enum ConfigError {
    /// The file cannot be read.
    Unreadable {
        /// Its name.
        file: String,
        /// Why.
        source: std::io::Error,
    },
    /// The file says what it may not: each problem with its place.
    Invalid {
        /// Its name.
        file: String,
        /// At least one.
        problems: Vec<Problem>,
    },
}

/// One thing that is wrong, and where.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct Problem {
    /// Line of the file, from 1; none for what the file does not say.
    pub line: Option<usize>,
    /// The key, with its sections: `autopilot.envelope.max_bank_deg`.
    pub key: Option<String>,
    /// What is wrong and what would be right.
    pub message: String,
}

impl ConfigError {
    pub(super) fn syntax(file: &str, text: &str, error: &toml::de::Error) -> Self {
        let span = error.span();
        let line = span.as_ref().map(|span| line_of(text, span));
        // The key of the line, if the error points into one: the message often
        // names the value only.
        let key = line
            .and_then(|line| text.lines().nth(line - 1))
            .and_then(|line| line.split_once('='))
            .map(|(key, _)| key.trim().to_owned());
        Self::Invalid {
            file: file.to_owned(),
            problems: vec![Problem {
                line,
                key,
                message: error.message().replace('\n', " "),
            }],
        }
    }

    /// The problems, for tools to read.
    pub fn problems(&self) -> Vec<Problem> {
        match self {
            Self::Unreadable { source, .. } => vec![Problem {
                line: None,
                key: None,
                message: source.to_string(),
            }],
            Self::Invalid { problems, .. } => problems.clone(),
        }
    }
}

/// The line that a span of the text begins in, from 1.
pub(super) fn line_of(text: &str, span: &Range<usize>) -> usize {
    text.bytes()
        .take(span.start)
        .filter(|byte| *byte == b'\n')
        .count()
        + 1
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreadable { file, source } => {
                write!(
                    f,
                    "{file}: cannot be read: {source}. Give the path of a configuration file; \
                     examples are in the folder config/"
                )
            }
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
