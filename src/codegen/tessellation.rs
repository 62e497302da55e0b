//! The kernels of a tessellation.

use super::generate;
use super::{Edit, Error, NOTHING, Shader, Tuning, build, scan_constants};
use crate::plan::placement::Placement;
use crate::tessellate::Options;
use crate::tessellate::vertex::{Normal, Position, Tangent, Uv};

/// What a tessellation's kernels are made for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tessellation {
    pub degree: [u8; 2],
    pub rational: bool,
    /// Begins with the leaves of a word, not with roots.
    pub word: bool,
    /// The word is derived anew each frame.
    pub derived: bool,
    pub options: Options,
}

/// One kernel for each pass of [`crate::tessellate::passes`].
pub struct TessellationShaders {
    pub begin: Shader,
    pub decide: Shader,
    pub scan: Shader,
    pub split: Shader,
    pub advance: Shader,
    pub mark: Shader,
    pub tally: Shader,
    pub afford: Shader,
    pub finish: Shader,
    pub vertices: Shader,
    pub triangles: Shader,
    /// Where the word is derived: `recall`, `adopt` and `enter`.
    pub derived: Option<[Shader; 3]>,
}

/// Links and validates the kernels of a tessellation.
pub fn tessellation(what: &Tessellation, tuning: &Tuning) -> Result<TessellationShaders, Error> {
    tessellation_edited(what, tuning, None)
}

/// The same, with a text replaced on purpose.
#[doc(hidden)]
pub fn tessellation_edited(
    what: &Tessellation,
    tuning: &Tuning,
    edit: Option<&Edit>,
) -> Result<TessellationShaders, Error> {
    let constants = constants(what, tuning);
    let kernel = |name| build(name, &constants, NOTHING, edit);
    Ok(TessellationShaders {
        begin: kernel("begin")?,
        decide: kernel("decide")?,
        scan: build("scan", &scan_constants(tuning), NOTHING, edit)?,
        split: kernel("split")?,
        advance: kernel("advance")?,
        mark: kernel("mark")?,
        tally: kernel("tally")?,
        afford: kernel("afford")?,
        finish: kernel("finish")?,
        vertices: vertices(what, None, tuning, edit)?,
        triangles: kernel("triangles")?,
        derived: match what.derived {
            true => Some([kernel("recall")?, kernel("adopt")?, kernel("enter")?]),
            false => None,
        },
    })
}

/// Links and validates the kernel of the vertices, which go where the placement says.
pub fn vertices(
    what: &Tessellation,
    placement: Option<&Placement>,
    tuning: &Tuning,
    edit: Option<&Edit>,
) -> Result<Shader, Error> {
    let on = placement.is_some_and(|p| !p.on.is_empty());
    let constants = format!(
        "{}const PLACED = {};\nconst PLACED_ON = {on};\nconst ENVIRONMENT_QUADS = {}u;\nconst SEED = {}u;\n",
        constants(what, tuning),
        placement.is_some(),
        placement.map_or(1, |p| p.environment_words() / 4),
        placement.map_or(0, |p| p.seed),
    );
    let parts = |part: &str| (part == "displacement").then(|| generate::placement(placement));
    build("vertices", &constants, &parts, edit)
}

fn constants(what: &Tessellation, tuning: &Tuning) -> String {
    let [rows, columns] = what.degree.map(|d| u32::from(d) + 1);
    let format = what.options.format;
    let number = |n: u32, name: &str| format!("const {name} = {n}u;\n");
    let flag = |is: bool, name: &str| format!("const {name} = {is};\n");
    [
        number(tuning.workgroup, "WORKGROUP"),
        number(rows, "ROWS"),
        number(columns, "COLUMNS"),
        number(rows * columns, "POINTS"),
        number(rows.max(columns), "LINES"),
        flag(what.rational, "RATIONAL"),
        flag(what.word, "WORD"),
        flag(what.derived, "DERIVED"),
        flag(!what.options.seams, "SHARED"),
        flag(matches!(format.position, Position::Snorm16 { .. }), "POSITION_SNORM"),
        number(
            match format.normal {
                None => 0,
                Some(Normal::Float) => 1,
                Some(Normal::Octahedral) => 2,
            },
            "NORMAL",
        ),
        number(
            match format.tangent {
                None => 0,
                Some(Tangent::Float) => 1,
                Some(Tangent::Snorm8) => 2,
            },
            "TANGENT",
        ),
        number(
            match format.uv {
                None => 0,
                Some(Uv::Float) => 1,
                Some(Uv::Unorm16) => 2,
            },
            "UV",
        ),
        flag(format.source, "SOURCE"),
    ]
    .concat()
}
