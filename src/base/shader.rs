//! WGSL programs joined from files.
//!
//! A [`Module`] is one file of `wgsl/` with the values of its override constants. A
//! [`Program`] is a list of modules with an entry point. WGSL allows a name to be used before
//! its declaration, so the files are simply concatenated, in any order. Where a scene lacks
//! a feature, a stand-in with the same functions is joined instead.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::sync::Arc;

use thiserror::Error;
use wgpu::naga;

/// One WGSL file and the values of the override constants that it declares.
#[derive(Clone, Debug, PartialEq)]
pub struct Module {
    /// Path of the file from the root of the repository.
    pub path: &'static str,
    /// Text of the file.
    pub source: Cow<'static, str>,
    /// Name and value of every override constant of the file; booleans as 0 or 1.
    pub constants: Vec<(&'static str, f64)>,
    /// Path of a module that it can replace while its own parameters are zero. So a program can stay
    /// when a slider passes through zero.
    pub replaces: Option<String>,
}

impl Module {
    /// The module, which can replace another while its parameters are zero.
    pub fn replacing(self, path: &str) -> Self {
        Self {
            replaces: Some(path.into()),
            ..self
        }
    }

    /// The module, which can replace its stand-in, `NAME_off.wgsl`, while its parameters are zero.
    pub fn neutral(self) -> Self {
        let stand_in = self.path.replace(".wgsl", "_off.wgsl");
        self.replacing(&stand_in)
    }

    /// Whether the module serves where another one is asked for.
    fn serves(&self, other: &Self) -> bool {
        self == other || self.replaces.as_deref() == Some(other.path)
    }
}

/// Makes a [`Module`] from a file in `wgsl/`. The text is compiled in.
#[macro_export]
macro_rules! wgsl {
    ($path:literal $(, $name:literal = $value:expr)* $(,)?) => {
        $crate::base::shader::Module {
            path: concat!("wgsl/", $path),
            source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/wgsl/", $path)).into(),
            constants: vec![$(($name, $value)),*],
            replaces: None,
        }
    };
}

/// Texts that take precedence over those of the program: the text of a file by its path from the
/// root of the repository, `wgsl/pass/color.wgsl` for example, or `None`.
pub type Sources = Arc<dyn Fn(&str) -> Option<String> + Send + Sync>;

/// Joined modules with an entry point.
#[derive(Clone, Debug, PartialEq)]
pub struct Program {
    /// Name of the compute entry point, and of the program.
    pub entry: &'static str,
    /// The joined modules, in order.
    pub modules: Vec<Module>,
}

/// What can be wrong with a program.
#[derive(Debug, Error)]
pub enum ShaderError {
    /// The text does not parse or does not validate.
    #[error("{path}:{line}: {message} (program `{entry}`)")]
    Text {
        /// The file with the error.
        path: String,
        /// Its line, from 1.
        line: usize,
        /// What naga says.
        message: String,
        /// The program's entry point.
        entry: &'static str,
    },
}

impl Program {
    /// A program of the given modules.
    pub fn new(entry: &'static str, modules: Vec<Module>) -> Self {
        Self { entry, modules }
    }

    /// Whether the program can replace another, whose parameters it gets.
    pub fn serves(&self, other: &Self) -> bool {
        let mut pairs = self.modules.iter().zip(&other.modules);
        self.entry == other.entry
            && self.modules.len() == other.modules.len()
            && pairs.all(|(own, other)| own.serves(other))
    }

    /// The joined text. Each module ends with a line break.
    pub fn source(&self) -> String {
        let lines = self.modules.iter().flat_map(|m| m.source.lines());
        lines.flat_map(|line| [line, "\n"]).collect()
    }

    /// All override constants with their values.
    pub fn constants(&self) -> Vec<(&'static str, f64)> {
        let all = self.modules.iter().flat_map(|m| &m.constants);
        all.copied().collect()
    }

    /// The file and the line in it that a line of the joined text comes from. Lines count
    /// from 1.
    pub fn locate(&self, line: usize) -> (&'static str, usize) {
        let mut left = line.max(1);
        for module in &self.modules {
            let lines = module.source.lines().count();
            if left <= lines {
                return (module.path, left);
            }
            left -= lines;
        }
        // The joined text ends too early.
        self.modules
            .last()
            .map_or(("", 1), |m| (m.path, m.source.lines().count()))
    }

    /// Parses and validates the joined text, and checks that exactly the declared constants
    /// have values.
    pub fn validate(
        &self,
        capabilities: naga::valid::Capabilities,
    ) -> Result<(naga::Module, naga::valid::ModuleInfo), ShaderError> {
        let source = self.source();
        let parsed = naga::front::wgsl::parse_str(&source);
        let module = parsed.map_err(|e| self.misread(&source, &e))?;
        if module.entry_points.iter().all(|e| e.name != self.entry) {
            return Err(self.fault(self.entry_at(), "the entry point is missing".into()));
        }
        let mut validator =
            naga::valid::Validator::new(naga::valid::ValidationFlags::all(), capabilities);
        let info = validator.validate(&module).map_err(|e| {
            // The first span is the whole function, the shortest one is the fault.
            let spans = e.spans().filter(|(span, _)| span.is_defined());
            let fault = spans.min_by_key(|(s, _)| s.to_range().map_or(usize::MAX, |r| r.len()));
            let line = fault.map_or(1, |(s, _)| s.location(&source).line_number as usize);
            let cause = std::error::Error::source(e.as_inner())
                .map_or_else(String::new, |c| format!(": {c}"));
            self.fault(self.locate(line), format!("{}{cause}", e.as_inner()))
        })?;
        self.check_constants(&source, &module)?;
        Ok((module, info))
    }

    /// The fault of a text that does not parse. Where a module lacks its end, the parser meets it in a
    /// later one.
    fn misread(&self, source: &str, e: &naga::front::wgsl::ParseError) -> ShaderError {
        let at = e.location(source);
        let at_end = at.is_some_and(|at| at.offset as usize >= source.trim_end().len());
        let place = self.locate(at.map_or(1, |at| at.line_number as usize));
        let unended = |m: &Module| unended(&m.source).map(|(line, what)| (m.path, line, what));
        match self.modules.iter().find_map(unended) {
            Some((path, line, what)) if path != place.0 || at_end => self.fault((path, line), what),
            _ => self.fault(place, e.message().to_string()),
        }
    }

    /// The file and the line of a span of the joined text.
    pub fn place(&self, source: &str, span: naga::Span) -> (&'static str, usize) {
        self.locate(span.location(source).line_number as usize)
    }

    /// The file and the line of the entry point; where it is missing, those of the file of its name.
    pub fn entry_at(&self) -> (&'static str, usize) {
        let head = format!("fn {}(", self.entry);
        let line = self.source().lines().position(|line| line.contains(&head));
        let file = format!("/{}.wgsl", self.entry);
        let own = self.modules.iter().find(|m| m.path.ends_with(&file));
        let own = own.or(self.modules.last()).map_or("", |m| m.path);
        line.map_or((own, 1), |line| self.locate(line + 1))
    }

    /// An error in a line of a file.
    pub fn fault(&self, (path, line): (&'static str, usize), message: String) -> ShaderError {
        ShaderError::Text {
            path: path.to_string(),
            line,
            message,
            entry: self.entry,
        }
    }

    fn check_constants(&self, source: &str, module: &naga::Module) -> Result<(), ShaderError> {
        let mut declared = BTreeSet::new();
        let given: BTreeSet<_> = self.constants().into_iter().map(|(name, _)| name).collect();
        for (handle, constant) in module.overrides.iter() {
            let name = constant.name.as_deref().unwrap_or_default();
            declared.insert(name);
            if !given.contains(name) {
                let at = self.place(source, module.overrides.get_span(handle));
                let message = format!("nothing gives the override constant `{name}` a value");
                return Err(self.fault(at, message));
            }
        }
        for module in &self.modules {
            let names = module.constants.iter().map(|(name, _)| name);
            if let Some(name) = names.into_iter().find(|name| !declared.contains(*name)) {
                let message = format!("the override constant `{name}` is missing");
                return Err(self.fault((module.path, 1), message));
            }
        }
        Ok(())
    }

    /// A listing of modules and constants, for `--explain`. It leaves out the stand-ins,
    /// `NAME_off.wgsl`, which do nothing.
    pub fn describe(&self) -> String {
        let mut text = String::new();
        let stands_in = |m: &&Module| m.path.ends_with("_off.wgsl");
        for module in self.modules.iter().filter(|m| !stands_in(m)) {
            let _ = write!(text, "    {}", module.path);
            for (name, value) in &module.constants {
                let _ = write!(text, "  {name}={value}");
            }
            text.push('\n');
        }
        text
    }
}

/// The line, from 1, of what a text begins and does not end, and what it is.
fn unended(text: &str) -> Option<(usize, String)> {
    let mut open: Vec<(char, usize)> = Vec::new();
    let (mut comments, mut in_line_comment) = (0, false);
    // The last character that is not of a comment, and its line.
    let mut last = None;
    let mut line = 1;
    let mut rest = text.chars().peekable();
    while let Some(c) = rest.next() {
        let pair = (c, rest.peek().copied().unwrap_or('\n'));
        if c == '\n' {
            line += 1;
            in_line_comment = false;
        } else if in_line_comment {
        } else if pair == ('/', '*') {
            comments += 1;
            rest.next();
        } else if comments > 0 {
            if pair == ('*', '/') {
                comments -= 1;
                rest.next();
            }
        } else if pair == ('/', '/') {
            in_line_comment = true;
        } else if !c.is_whitespace() {
            last = Some((c, line));
            let opener = match c {
                ')' => '(',
                ']' => '[',
                '}' => '{',
                _ => {
                    if "([{".contains(c) {
                        open.push((c, line));
                    }
                    continue;
                }
            };
            match open.pop() {
                Some((found, _)) if found == opener => {}
                Some((found, at)) => return Some((at, format!("`{found}` has no end"))),
                None => return Some((line, format!("`{c}` ends nothing"))),
            }
        }
    }
    if let Some((found, at)) = open.first() {
        return Some((*at, format!("`{found}` has no end")));
    }
    let (c, at) = last?;
    (!";}".contains(c)).then(|| (at, "the declaration has no `;` at its end".into()))
}
