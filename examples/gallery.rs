//! The pictures of the README: rule files derived and patches tessellated on the GPU, and drawn.
//!
//!     cargo run --release --example gallery [-- FOLDER]

use burgeon::gpu::tessellate::{Capacity, Tessellator};
use burgeon::gpu::{self, Engine, Headless, Requirement};
use burgeon::io::{NetOptions, png, read_nets, values, write_atomically};
use burgeon::language::expr::Type;
use burgeon::language::{System, Value, Vocabulary, compile, diagnostic};
use burgeon::patch::{Axiom, Module, Net, Word};
use burgeon::plan::{Options, Plan};
use burgeon::render::{self, Camera, Picture};
use burgeon::tessellate::{self, Level, Mesh, grid};
use std::error::Error;
use std::path::{Path, PathBuf};

const COPPER: [u8; 3] = [217, 155, 108];
const TEAL: [u8; 3] = [72, 150, 150];
const PLUM: [u8; 3] = [150, 92, 122];
const SAND: [u8; 3] = [222, 196, 140];
const MEADOW: [u8; 3] = [126, 158, 92];
const ROCK: [u8; 3] = [168, 160, 156];

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).unwrap_or("out/gallery".into());
    std::fs::create_dir_all(&folder)?;
    let studio = Studio::new(folder.into())?;
    let copper = |_: &Module| COPPER;

    // The tensor-product paper's figure 4, after three and six steps; the quadrants tell their symbols
    // apart.
    let quadrant = |module: &Module| [COPPER, COPPER, COPPER, TEAL, PLUM][module.symbol];
    for depth in [3, 6] {
        let word = studio.derive("sierpinski", &[("depth", depth)])?;
        studio.draw(&format!("sierpinski_{depth}"), &word, quadrant, sheet())?;
    }

    // Figure 1: a fractal surface by a stochastic ε-rule, in perspective and from the top.
    let word = studio.derive("fractal", &[])?;
    studio.draw("fractal", &word, copper, sheet())?;
    studio.draw("fractal_top", &word, copper, Picture { camera: Camera::Top, ..sheet() })?;

    // Figure 5: the second triangle grew from the second root.
    let word = studio.derive("sierpinski2", &[])?;
    studio.draw("double_sierpinski", &word, |module| [COPPER, TEAL][module.root as usize], sheet())?;

    // Section 2.6: regular holes.
    studio.draw("holes", &studio.derive("holes", &[])?, copper, sheet())?;

    // Section 2.5, figure 3: a rational cylinder, a colour for each of its four patches; a sphere and a
    // torus, which no polynomial net is.
    let word = studio.derive("cylinder", &[])?;
    let lines = grid::borders(&word, GRID)?;
    let four = |module: &Module| [COPPER, TEAL, PLUM, SAND][module.symbol];
    studio.draw("cylinder", &word, four, Picture { lines, line_width: 0.8, ..sheet() })?;
    studio.draw("sphere", &studio.derive("sphere", &[])?, copper, picture())?;
    studio.draw("torus", &studio.derive("torus", &[])?, |_| TEAL, sheet())?;

    // Section 2.4, figure 2: refined where it bends, and where it is near the eye.
    let hill = Picture { camera: Camera::Around { azimuth: -30.0, elevation: 34.0 }, ..picture() };
    for (name, system) in [("adaptive", "adaptive"), ("adaptive_near", "near")] {
        let word = studio.derive_with("adaptive", Some(system), Options::default())?;
        let lines = grid::borders(&word, cells(&word))?;
        studio.draw(name, &word, copper, Picture { lines, line_width: 0.8, ..hill.clone() })?;
    }

    // A height field whose patches follow the values of a grid.
    let grid_file = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/data/moisture.json");
    let bind = vec![("Moisture".to_string(), values::read(grid_file, &Type::Float)?)];
    let word = studio.derive_with("relief", None, Options { bind, ..Options::default() })?;
    let lines = grid::borders(&word, cells(&word))?;
    let ground = |module: &Module| [COPPER, MEADOW, SAND, ROCK][module.symbol];
    studio.draw("relief", &word, ground, Picture { lines, line_width: 0.35, ..hill.clone() })?;

    // The teapot as one watertight mesh, at three tolerances.
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let teapot = read_nets(examples.join("data/teapot.bpt"), NetOptions::default())?.value;
    for (name, tolerance) in [("coarse", 0.5), ("medium", 0.1), ("fine", 0.02)] {
        studio.tessellate(&format!("tessellate_{name}"), &teapot, tolerance)?;
    }

    // The same, displaced.
    studio.displace("quilted", Level { depth: 6..=12, ..Level::world(0.001) })?;

    // The teapot with the borders of its leaves, and as lace.
    let word = studio.derive("teapot", &[])?;
    let lines = grid::borders(&word, GRID)?;
    studio.draw("teapot", &word, copper, Picture { lines, line_width: 0.8, ..picture() })?;
    let wide = Picture { width: 1200, ..picture() };
    studio.draw("teapot_lace", &studio.derive("teapot_lace", &[])?, copper, wide)
}

/// Every leaf becomes so many cells squared, fewer where there are many leaves.
const GRID: usize = 8;

fn cells(word: &Word) -> usize {
    tessellate::grid_for(word.modules.len(), GRID)
}

fn picture() -> Picture {
    Picture { width: 800, height: 600, supersample: 3, ..Picture::default() }
}

/// A flat piece is best seen from higher up.
fn sheet() -> Picture {
    Picture { camera: Camera::Around { azimuth: -24.0, elevation: 42.0 }, ..picture() }
}

/// A device, an engine on it, and where the pictures go.
struct Studio {
    gpu: Headless,
    engine: Engine,
    folder: PathBuf,
}

impl Studio {
    fn new(folder: PathBuf) -> Result<Studio, Box<dyn Error>> {
        let gpu = Headless::new(Requirement::Any)?;
        let engine = Engine::new(&gpu.device, &gpu.queue);
        Ok(Studio { gpu, engine, folder })
    }

    /// From a rule file, with some of its params replaced, to the word that it derives.
    fn derive(&self, name: &str, params: &[(&str, i32)]) -> Result<Word, Box<dyn Error>> {
        let set = params.iter().map(|&(name, value)| (name.to_string(), Value::Int(value))).collect();
        self.derive_with(name, None, Options { set, ..Options::default() })
    }

    /// The same of one of several systems, and with all options.
    fn derive_with(
        &self,
        name: &str,
        system: Option<&str>,
        options: Options,
    ) -> Result<Word, Box<dyn Error>> {
        let (plan, axiom) = load(name, system)?;
        let (word, _) = gpu::derive(&self.engine, &plan, &axiom, &options)?;
        println!("{name}: {} steps, {} patches", word.steps, word.modules.len());
        Ok(word)
    }

    /// Tessellates the word of a rule file, displaced by its placement, and writes the picture.
    fn displace(&self, name: &str, level: Level) -> Result<(), Box<dyn Error>> {
        let (plan, axiom) = load(name, None)?;
        let (word, _) = gpu::derive(&self.engine, &plan, &axiom, &Options::default())?;
        let nets: Vec<Net> = axiom.roots.into_iter().map(|root| root.net).collect();
        let (options, room) = (tessellate::Options::default(), Capacity::for_vertices(1 << 17));
        let mut tessellator =
            Tessellator::of_word(&self.engine, &nets, &word, plan.hole, &level, &options, &room)?;
        tessellator.displace(&plan, &Options::default())?;
        let mesh = tessellator.complete()?.mesh;
        println!("{name}: {} triangles", mesh.triangles().len());
        self.render(name, &mesh, picture())
    }

    /// Tessellates the nets within the tolerance, and writes the picture with the edges of all triangles.
    fn tessellate(&self, name: &str, nets: &[Net], tolerance: f32) -> Result<(), Box<dyn Error>> {
        let (level, options) = (Level::world(tolerance), tessellate::Options::default());
        let room = Capacity::for_vertices(1 << 14);
        let mesh = Tessellator::new(&self.engine, nets, &level, &options, &room)?.complete()?.mesh;
        println!("{name}: {} triangles", mesh.triangles().len());
        self.render(name, &mesh, Picture { lines: mesh.edges(), line_width: 0.7, ..picture() })
    }

    /// Dices the word, every leaf in its `color`, and writes the picture.
    fn draw(
        &self,
        name: &str,
        word: &Word,
        color: impl Fn(&Module) -> [u8; 3],
        picture: Picture,
    ) -> Result<(), Box<dyn Error>> {
        let n = cells(word);
        let mesh = tessellate::dice(word, n)?;
        let picture = Picture { colors: tessellate::per_vertex(word, n, color), ..picture };
        self.render(name, &mesh, picture)
    }

    fn render(&self, name: &str, mesh: &Mesh, picture: Picture) -> Result<(), Box<dyn Error>> {
        let image = render::render(&self.gpu.device, &self.gpu.queue, mesh, &picture)?;
        let path = self.folder.join(name).with_extension("png");
        write_atomically(&path, |writer| png::write(writer, &image))?;
        println!("  {}", path.display());
        Ok(())
    }
}

/// A rule file of this folder: the plan of one of its systems, the last if none is named, and its axiom.
fn load(name: &str, system: Option<&str>) -> Result<(Plan, Axiom), Box<dyn Error>> {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let file = examples.join(name).with_extension("burgeon");
    let text = std::fs::read_to_string(&file)?;
    let checked = compile(&text, &Vocabulary::default());
    if checked.has_errors() {
        let file = file.display().to_string();
        return Err(diagnostic::render(&checked.diagnostics, &file, &text, false).into());
    }
    let wanted = |s: &&System| system.is_none_or(|name| s.name == name);
    let system = checked.systems.iter().rfind(wanted).ok_or("no system of that name")?;
    let plan = Plan::new(system)?;
    let nets = NetOptions { rational: plan.rational(), bspline: true };
    let read = |file: &str| read_nets(examples.join(file), nets).map(|read| read.value);
    let axiom = Axiom::load(&plan.system, &mut |file| read(file))?;
    Ok((plan, axiom))
}
