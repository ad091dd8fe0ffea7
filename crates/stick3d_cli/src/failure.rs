//! What went wrong, sorted by the exit code it ends with.

use std::fmt::Display;
use std::process::ExitCode;

/// An error and the exit code it ends the command with; the codes are listed in `stick3d --help`.
#[derive(Debug)]
pub(crate) struct Failure {
    code: u8,
    error: anyhow::Error,
}

/// The result of a command.
pub(crate) type Outcome<T = ()> = Result<T, Failure>;

impl Failure {
    /// The command line is wrong, in a way that its parser does not see.
    pub(crate) fn usage(error: impl Into<anyhow::Error>) -> Self {
        Self {
            code: 2,
            error: error.into(),
        }
    }

    /// A sketch, clip, rig, pose or figure file is wrong.
    pub(crate) fn input(error: impl Into<anyhow::Error>) -> Self {
        Self {
            code: 3,
            error: error.into(),
        }
    }

    /// A model file is wrong.
    pub(crate) fn model(error: impl Into<anyhow::Error>) -> Self {
        Self {
            code: 4,
            error: error.into(),
        }
    }

    /// An output could not be written.
    pub(crate) fn output(error: impl Into<anyhow::Error>) -> Self {
        Self {
            code: 5,
            error: error.into(),
        }
    }

    /// Puts what was being done before the message.
    pub(crate) fn context(self, what: impl Display + Send + Sync + 'static) -> Self {
        Self {
            error: self.error.context(what),
            ..self
        }
    }

    /// One line: the whole chain, from what was being done to why it failed.
    pub(crate) fn message(&self) -> String {
        format!("{:#}", self.error)
    }

    /// The exit code.
    pub(crate) fn exit_code(&self) -> ExitCode {
        ExitCode::from(self.code)
    }
}

impl From<anyhow::Error> for Failure {
    fn from(error: anyhow::Error) -> Self {
        Self { code: 1, error }
    }
}
