//! From a file to a scene that is known to be right.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use serde_saphyr::{NonFiniteFloatPolicy, Options, Spanned};

use super::check::{Field, Problems};
use super::tree::{self, Tree};
use super::{Problem, Scene, SceneError, syntax, unavailable};

/// Largest scene file; longer histories belong into a CSV.
const MAX_BYTES: u64 = 1 << 20;

/// A scene with the place it came from.
#[derive(Clone, Debug, PartialEq)]
pub struct Loaded {
    /// The scene.
    pub scene: Scene,
    /// The file.
    pub file: PathBuf,
}

impl Loaded {
    /// A file that the scene names: relative ones are meant from the scene file's folder.
    #[must_use]
    pub fn resolve(&self, file: &Path) -> PathBuf {
        self.folder().join(file)
    }

    /// The scene file's folder.
    #[must_use]
    pub fn folder(&self) -> &Path {
        self.file.parent().unwrap_or(Path::new(""))
    }
}

/// Reads a scene file and checks the whole.
///
/// # Errors
/// When the file cannot be read, is no YAML of a scene, or holds a value that is not allowed; all
/// values that are not allowed are named at once.
pub fn load(file: &Path) -> Result<Loaded, SceneError> {
    let mut bytes = Vec::new();
    File::open(file)
        .and_then(|open| open.take(MAX_BYTES + 1).read_to_end(&mut bytes))
        .map_err(|source| SceneError::Read { file: file.into(), source })?;
    let alone = |line, text: &str| {
        let position = Some((line, 1));
        let (file, text) = (file.into(), text.into());
        SceneError::Invalid(vec![Problem { file, position, field: String::new(), text }])
    };
    if bytes.len() as u64 > MAX_BYTES {
        return Err(alone(1, "larger than 1 MiB; long histories belong into a CSV"));
    }
    let text = std::str::from_utf8(&bytes).map_err(|error| {
        let before = &bytes[..error.valid_up_to()];
        let line = 1 + before.iter().filter(|&&byte| byte == b'\n').count() as u64;
        alone(line, "not UTF-8")
    })?;
    let scene = parse(text, file)?;
    Ok(Loaded { scene, file: file.into() })
}

/// Reads a scene from text and checks the whole; `file` is what errors name.
///
/// # Errors
/// As [`load`].
pub fn parse(text: &str, file: &Path) -> Result<Scene, SceneError> {
    let problem = |(field, position, text): (Field, _, _)| Problem {
        file: file.into(),
        position,
        field: field.to_string(),
        text,
    };
    let root: Spanned<Tree> = serde_saphyr::from_str_with_options(text, options())
        .map_err(|error| SceneError::Invalid(vec![problem(syntax::explain(&error, None))]))?;
    let all = |problems: Problems| {
        if problems.0.is_empty() {
            return Ok(());
        }
        let place = |(field, text)| {
            let position = tree::position(&root, &field);
            problem((field, position, text))
        };
        Err(SceneError::Invalid(problems.0.into_iter().map(place).collect()))
    };

    let mut problems = Problems::default();
    if !matches!(root.value, Tree::Map(_)) {
        let text =
            format!("{} stands here; allowed: a scene, at least `pack: ...`", root.value.kind());
        problems.add(Field::root(), text);
    }
    unavailable::check(&root, &mut problems);
    all(problems)?;

    let scene: Scene = serde_saphyr::from_str_with_options(text, options()).map_err(|error| {
        SceneError::Invalid(vec![problem(syntax::explain(&error, Some(&root)))])
    })?;
    let mut problems = Problems::default();
    scene.check(&mut problems);
    all(problems)?;
    Ok(scene)
}

fn options() -> Options {
    serde_saphyr::options! {
        with_snippet: false,
        // The ranges of the fields refuse them, by name.
        non_finite_float_policy: NonFiniteFloatPolicy::PassThrough,
        strict_booleans: true,
    }
}
