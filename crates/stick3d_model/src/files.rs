//! Writing files and folders so that a crash never leaves half of one.

use std::io::{self, Write as _};
use std::path::Path;

/// Writes `bytes` to a temporary file beside `path`, then renames it over `path`.
///
/// # Errors
/// Whatever the file system answers; the message names `path`. What stood at `path` before is then untouched.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let attempt = || -> io::Result<()> {
        let mut file = builder().tempfile_in(folder_of(path))?;
        file.write_all(bytes)?;
        file.as_file().sync_all()?;
        file.persist(path)?;
        Ok(())
    };
    attempt().map_err(|error| about(path, &error))
}

/// Writes files, each a name and its bytes, into a new folder: into a temporary folder beside `path`, then renamed to it. A
/// folder that is there already must be empty.
///
/// # Errors
/// The first error among the files, or whatever the file system answers; then nothing is written.
pub fn write_folder_atomically<E: From<io::Error>>(
    path: &Path,
    files: impl IntoIterator<Item = Result<(String, Vec<u8>), E>>,
) -> Result<(), E> {
    let about = |error: io::Error| about(path, &error);
    require_no_files(path)?;
    let folder = folder_of(path);
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        builder.permissions(std::fs::Permissions::from_mode(0o777));
    }
    let temporary = builder.tempdir_in(folder).map_err(about)?;
    for file in files {
        let (name, bytes) = file?;
        let file = std::fs::File::create(temporary.path().join(name));
        file.and_then(|mut file| file.write_all(&bytes))
            .map_err(about)?;
    }
    if path.is_dir() {
        // Refuses to remove anything but an empty folder.
        std::fs::remove_dir(path).map_err(about)?;
    }
    std::fs::rename(temporary.path(), path).map_err(about)?;
    // It is no longer where it would be removed from.
    let _ = temporary.keep();
    Ok(())
}

/// Whether `path` is free for [`write_folder_atomically`]: not there, or an empty folder.
///
/// # Errors
/// Says what stands there.
pub fn require_no_files(path: &Path) -> io::Result<()> {
    let taken = match std::fs::read_dir(path) {
        Ok(mut entries) => entries.next().is_some(),
        Err(_) => path.exists(),
    };
    if taken {
        let error = io::Error::new(
            io::ErrorKind::AlreadyExists,
            "it is there already and is not an empty folder; name a new one",
        );
        return Err(about(path, &error));
    }
    Ok(())
}

/// The folder in which something stands.
fn folder_of(path: &Path) -> &Path {
    let folder = path.parent();
    folder
        .filter(|folder| !folder.as_os_str().is_empty())
        .unwrap_or(Path::new("."))
}

/// An error that names what could not be written.
fn about(path: &Path, error: &io::Error) -> io::Error {
    io::Error::new(
        error.kind(),
        format!("cannot write {}: {error}", path.display()),
    )
}

/// Temporary files are private by habit; these become ordinary files, readable as the user's umask says.
fn builder() -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder
}

#[cfg(test)]
mod tests {
    use super::write_atomically;

    #[test]
    fn replaces_the_file_and_leaves_nothing_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.bin");
        write_atomically(&path, b"one").unwrap();
        write_atomically(&path, b"two").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"two");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn the_file_is_as_readable_as_any_other() {
        use std::os::unix::fs::PermissionsExt as _;
        let folder = tempfile::tempdir().unwrap();
        let (ours, plain) = (folder.path().join("ours"), folder.path().join("plain"));
        write_atomically(&ours, b"x").unwrap();
        std::fs::File::create(&plain).unwrap();
        let mode = |path| std::fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&ours), mode(&plain));
    }

    #[test]
    fn says_which_file_could_not_be_written() {
        let error = write_atomically("/nonexistent-folder/out.bin".as_ref(), b"x").unwrap_err();
        assert!(
            error.to_string().contains("/nonexistent-folder/out.bin"),
            "{error}"
        );
    }
}
