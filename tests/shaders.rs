//! What codegen hands to drivers: valid for core WebGPU, translatable, and in step with the plan.

use crate::{oracle, tier};
use burgeon::codegen::{self, Edit, GENERATED, Mapping, Shader, Tuning};
use burgeon::language::{Severity, Span, Vocabulary, compile};
use burgeon::plan::derive::StageId;
use burgeon::plan::step::{Clock, Column, Extent, Pass, Status};
use burgeon::plan::turns::{Progress, TurnWords};
use burgeon::plan::{Plan, Stored};
use naga::back::{glsl, hlsl, msl, spv};
use naga::proc::{BoundsCheckPolicies, Layouter};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{AddressSpace, GlobalVariable, Module, StorageAccess, TypeInner};
use std::mem::offset_of;
use std::path::{Path, PathBuf};

/// All mappings of `emit` are among them.
const TUNINGS: [Tuning; 3] =
    [Tuning::CPU_DRIVER, Tuning::GPU, Tuning { mapping: Mapping::LinePerInvocation, ..Tuning::GPU }];

/// WebGPU's default limits.
const STORAGE_BUFFERS: usize = 8;
const INVOCATIONS: u32 = 256;
const WORKGROUP_BYTES: u32 = 16 << 10;

// --- which shaders there are ---------------------------------------------------------------------

/// The files of these folders that end in `extension`, in order.
fn files(folder: &str, extension: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|e| panic!("{folder}: {e}"));
    let paths = entries.map(|entry| entry.expect("an entry").path());
    let mut files: Vec<PathBuf> =
        paths.filter(|path| path.extension().is_some_and(|e| e == extension)).collect();
    files.sort();
    assert!(!files.is_empty(), "{folder} holds no .{extension} files");
    files
}

fn stem(path: &Path) -> String {
    path.file_stem().expect("a name").to_string_lossy().into_owned()
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// The plans of a text's patch systems that this version derives.
fn plans(text: &str) -> Vec<Plan> {
    let checked = compile(text, &Vocabulary::default());
    if checked.diagnostics.iter().any(|d| d.severity == Severity::Error) {
        return Vec::new();
    }
    checked.systems.iter().filter_map(|system| Plan::new(system).ok()).collect()
}

/// The plans of all systems that are written down, with the file's name.
fn written_plans() -> Vec<(String, Plan)> {
    let mut list = Vec::new();
    for file in files("examples", "burgeon") {
        let found = plans(&read(&file));
        assert!(!found.is_empty(), "{} is an example that is not derived", file.display());
        list.extend(found.into_iter().map(|plan| (stem(&file), plan)));
    }
    let of_the_language = files("tests/data/language", "burgeon");
    let of_the_language =
        of_the_language.iter().flat_map(|f| plans(&read(f)).into_iter().map(|p| (stem(f), p)));
    list.extend(of_the_language);
    list
}

fn stage_shaders(plan: &Plan, id: StageId, tuning: &Tuning) -> Vec<Shader> {
    codegen::stage(plan, id, tuning).unwrap_or_else(|e| panic!("{e}"))
}

/// All kernels of a plan, those of a derivation that is recorded among them.
fn shaders(plan: &Plan, tuning: &Tuning) -> Vec<Shader> {
    let staged = plan.stages().into_iter().flat_map(|id| stage_shaders(plan, id, tuning));
    let shared = codegen::shared(plan, tuning).unwrap_or_else(|e| panic!("{e}"));
    let recorded =
        [codegen::proceed_edited(tuning, None), codegen::start_word_edited(&plan.tables.layout, None)];
    staged.chain(shared).chain(recorded.map(|shader| shader.unwrap_or_else(|e| panic!("{e}")))).collect()
}

fn small_plan() -> Plan {
    plans(SMALL).swap_remove(0)
}

fn small_curve() -> Plan {
    plans(CURVE).swap_remove(0)
}

/// Modules with links, which are traced.
fn small_links() -> Plan {
    crate::turtle::linked_plan()
}

/// Contexts on both sides, ends, erasure, chance, and parameters of all types.
const CURVE: &str = "\
system small : curve open
module P(v: vec3, k: int), Q, T(r: float, v: vec2)
axiom: P((0, 0, 0), 1) P((1, 0, 0), 2) F +(30) F &(20) F !(2)
rules:
  # < P(v, k) > P(w, 3) -> P(v, k) P((v + w) / 2, k + 1)
  P(a, _) Q < P(v, k) : rand() < 0.5 -> (1) P(a, k) Q P(v, k) -> (2) Q
  Q P(v, _) > Q -> P(v, 2)
  Q -> eps
run:
  derive 3
  trace into T
";

/// A system with a condition, attributes, an expression in every place, and a nested block.
const SMALL: &str = "\
system small : patch bezier 3
module P(n: int, k: bool), Q
axiom: P(0, true) = file \"sheet.bpt\"
rules:
  P(n, k) : n < 3 && k -> [ P(n/2 + level, !k) [ Q | P(n, k) ] ; eps Q ]
  P(n, k) : n > 5 -> eps
  P(n, k) : flatness + bbox_px + uv.x > 1000 -> eps
run:
  derive 3
";

// --- naga ----------------------------------------------------------------------------------------

#[track_caller]
fn validated(shader: &Shader) -> ModuleInfo {
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
    validator.validate(&shader.module).unwrap_or_else(|e| panic!("{}: {e:?}", shader.name))
}

/// Translates a kernel to every language that wgpu's backends speak.
fn translate(shader: &Shader) -> Result<(), String> {
    let (module, info) = (&shader.module, &validated(shader));
    let failed = |language: &str, error: &dyn std::fmt::Display| format!("{language}: {error}");
    spv::write_vec(module, info, &spv::Options::default(), None).map_err(|e| failed("SPIR-V", &e))?;
    msl::write_string(module, info, &msl::Options::default(), &msl::PipelineOptions::default())
        .map_err(|e| failed("MSL", &e))?;
    let (options, pipeline) = (hlsl::Options::default(), hlsl::PipelineOptions::default());
    hlsl::Writer::new(&mut String::new(), &options, &pipeline)
        .write(module, info, None)
        .map_err(|e| failed("HLSL", &e))?;
    let options = glsl::Options { version: glsl::Version::new_gles(310), ..glsl::Options::default() };
    for entry in &module.entry_points {
        let pipeline = glsl::PipelineOptions {
            shader_stage: entry.stage,
            entry_point: entry.name.clone(),
            multiview: None,
        };
        let policies = BoundsCheckPolicies::default();
        glsl::Writer::new(&mut String::new(), module, info, &options, &pipeline, policies)
            .and_then(|mut writer| writer.write())
            .map_err(|e| failed(&format!("GLSL ES, {}", entry.name), &e))?;
    }
    Ok(())
}

#[track_caller]
pub fn assert_translates(shader: &Shader, of: &str) {
    if let Err(e) = translate(shader) {
        panic!("{} of {of} to {e}\n{}", shader.name, shader.source);
    }
}

#[test]
fn every_kernel_of_every_written_system_translates_to_every_language() {
    let plans = written_plans();
    assert!(plans.len() >= 7, "{:?}", plans.iter().map(|p| &p.0).collect::<Vec<_>>());
    for (name, plan) in &plans {
        for tuning in &TUNINGS {
            shaders(plan, tuning).iter().for_each(|shader| assert_translates(shader, name));
        }
    }
    for tuning in &TUNINGS {
        let measures = codegen::measures(tuning).expect("copy and expand");
        measures.iter().for_each(|shader| assert_translates(shader, "the measures"));
    }
}

/// Degrees of nets; a sample has each along u and each along v.
pub fn pairs() -> impl Iterator<Item = [u8; 2]> {
    let all = (1..=8).flat_map(|m| (1..=8).map(move |n| [m, n]));
    all.filter(|[m, n]| (m + 3 * n) % tier::cases(5, 1) == 0 || m == n && *m == 3)
}

#[test]
fn emit_translates_for_every_degree() {
    for [m, n] in pairs() {
        let plan = plans(&SMALL.replace("bezier 3", &format!("bezier {m} {n} rational"))).swap_remove(0);
        for (tuning, id) in TUNINGS.iter().flat_map(|t| plan.stages().into_iter().map(move |id| (t, id))) {
            let emit = stage_shaders(&plan, id, tuning).pop().expect("kernels");
            assert!(emit.name.starts_with("emit"), "{}", emit.name);
            assert_translates(&emit, &format!("degree {m}×{n}"));
        }
    }
}

#[test]
fn every_kernel_of_random_systems_translates_to_every_language() {
    for seed in 0..tier::cases(16, 60) {
        let case = oracle::case(seed);
        let tuning = &TUNINGS[seed as usize % TUNINGS.len()];
        let plans = plans(&case.text);
        assert!(!plans.is_empty(), "{case}");
        for plan in plans {
            let staged = plan.stages().into_iter().flat_map(|id| stage_shaders(&plan, id, tuning));
            staged.for_each(|shader| assert_translates(&shader, &case.to_string()));
        }
    }
}

// --- bindings ------------------------------------------------------------------------------------

/// What a column is called in WGSL, and what it holds.
fn expected(column: Column) -> (&'static str, &'static str) {
    use Stored::{Nets, Records};
    match column {
        Column::Before(Records) => ("records", "array<vec4<u32>>"),
        Column::Before(Nets) => ("nets", "array<vec4<f32>>"),
        Column::After(Records) => ("next_records", "array<vec4<u32>>"),
        Column::After(Nets) => ("next_nets", "array<vec4<f32>>"),
        Column::Finished(Records) => ("finished_records", "array<vec4<u32>>"),
        Column::Finished(Nets) => ("finished_nets", "array<vec4<f32>>"),
        Column::Rules => ("rules", "array<u32>"),
        Column::Attributes => ("attributes", "array<u32>"),
        Column::Counts => ("counts", "array<u32>"),
        Column::Offsets => ("offsets", "array<u32>"),
        Column::Links => ("links", "array<u32>"),
        Column::Sums | Column::RetiredSums => ("sums", "array<u32>"),
        Column::TileMotions | Column::Motions => ("motions", "array<Motion>"),
        Column::Carried => ("carried", "array<Motion>"),
        Column::Retired => ("retired", "array<u32>"),
        Column::Status => ("status", "Status"),
        Column::Environment => ("environment", "array<vec4<u32>>"),
        Column::Extent => ("extent", "Extent"),
    }
}

/// The name of a type, but for the length of an array.
fn type_name(module: &Module, ty: naga::Handle<naga::Type>) -> String {
    let ty = &module.types[ty];
    match &ty.inner {
        _ if ty.name.is_some() => ty.name.clone().unwrap_or_default(),
        TypeInner::Array { base, .. } => format!("array<{}>", type_name(module, *base)),
        TypeInner::Vector { size, scalar } => format!("vec{}<{}>", *size as u8, scalar_name(*scalar)),
        TypeInner::Scalar(scalar) | TypeInner::Atomic(scalar) => scalar_name(*scalar),
        other => format!("{other:?}"),
    }
}

fn scalar_name(scalar: naga::Scalar) -> String {
    let kind = match scalar.kind {
        naga::ScalarKind::Uint => "u",
        naga::ScalarKind::Float => "f",
        other => panic!("{other:?}"),
    };
    format!("{kind}{}", scalar.width * 8)
}

/// A binding as text: group, binding, space with access, name, type.
type Seen = (u32, u32, String, String, String);

fn seen(module: &Module) -> Vec<Seen> {
    let of = |v: &GlobalVariable| {
        let at = v.binding?;
        let name = v.name.clone().unwrap_or_default();
        Some((at.group, at.binding, format!("{:?}", v.space), name, type_name(module, v.ty)))
    };
    let mut list: Vec<Seen> = module.global_variables.iter().filter_map(|(_, v)| of(v)).collect();
    list.sort();
    list
}

fn wanted(pass: Pass) -> Vec<Seen> {
    // What only linked words bind is declared for all.
    let links = matches!(pass, Pass::Match | Pass::EmitWord).then_some((Column::Links, false));
    let columns = pass.row().bindings().chain(links);
    let binding = |(n, (column, written)): (usize, (Column, bool))| {
        let space = match column {
            Column::Extent | Column::Environment => AddressSpace::Uniform,
            _ if written => AddressSpace::Storage { access: StorageAccess::LOAD | StorageAccess::STORE },
            _ => AddressSpace::Storage { access: StorageAccess::LOAD },
        };
        let (name, ty) = expected(column);
        (0, n as u32, format!("{space:?}"), name.to_string(), ty.to_string())
    };
    columns.enumerate().map(binding).collect()
}

/// The kernels of a pass in all tunings.
fn kernels_of(pass: Pass) -> Vec<Shader> {
    let plans = [small_plan(), small_curve(), small_links()];
    let all = TUNINGS.iter().flat_map(|tuning| plans.iter().flat_map(|plan| shaders(plan, tuning)));
    // All mappings of emit have the entry point `emit`.
    let entry = pass.row().entries.last().expect("an entry");
    all.filter(|s| s.module.entry_points.iter().any(|e| e.name == *entry)).collect()
}

#[test]
fn bindings_are_the_columns_of_the_pass_in_order() {
    for pass in Pass::ALL {
        let (kernels, name) = (kernels_of(pass), pass.row().name);
        assert!(kernels.len() >= 2, "{name}");
        for shader in kernels {
            assert_eq!(seen(&shader.module), wanted(pass), "{name} ({})", shader.name);
            let entries: Vec<&str> = shader.module.entry_points.iter().map(|e| e.name.as_str()).collect();
            assert!(pass.row().entries.iter().all(|entry| entries.contains(entry)), "{name}: {entries:?}");
        }
    }
    let mut emits: Vec<&str> = kernels_of(Pass::Emit).iter().map(|s| s.name).collect();
    emits.dedup();
    assert_eq!(emits, ["emit", "emit_by_point", "emit_by_line"]);
}

/// Neither more buffers nor more workgroup memory and invocations than every WebGPU device has, and no
/// extension of the language.
#[track_caller]
pub fn assert_within_default_limits(shader: &Shader) {
    let module = &shader.module;
    let mut layouter = Layouter::default();
    layouter.update(module.to_ctx()).expect("a layout");
    let in_space = |wanted: fn(AddressSpace) -> bool| {
        module.global_variables.iter().map(|(_, v)| v).filter(move |v| wanted(v.space)).collect::<Vec<_>>()
    };
    let storage = in_space(|space| matches!(space, AddressSpace::Storage { .. }));
    assert!(storage.len() <= STORAGE_BUFFERS, "{}: {} storage buffers", shader.name, storage.len());
    let workgroup = in_space(|space| space == AddressSpace::WorkGroup);
    let bytes: u32 = workgroup.iter().map(|v| layouter[v.ty].size.next_multiple_of(16)).sum();
    assert!(bytes <= WORKGROUP_BYTES, "{}: {bytes} bytes of workgroup memory", shader.name);
    assert!(!module.entry_points.is_empty(), "{}", shader.name);
    for entry in &module.entry_points {
        let [x, y, z] = entry.workgroup_size;
        assert!(x * y * z <= INVOCATIONS && z <= 64, "{}: {:?}", shader.name, entry.workgroup_size);
    }
    assert!(module.overrides.is_empty(), "{}: `override` is not for every backend", shader.name);
    for directive in ["enable ", "requires ", "diagnostic("] {
        assert!(!shader.source.contains(directive), "{}: {directive}", shader.name);
    }
}

#[test]
fn no_kernel_asks_for_more_than_default_limits() {
    let every_degree =
        pairs().map(|[m, n]| plans(&SMALL.replace("bezier 3", &format!("bezier {m} {n}"))).swap_remove(0));
    let plans: Vec<Plan> = every_degree.collect();
    for (plan, tuning) in plans.iter().flat_map(|plan| TUNINGS.iter().map(move |tuning| (plan, tuning))) {
        let measures = codegen::measures(tuning).expect("copy and expand");
        for shader in shaders(plan, tuning).iter().chain(&measures) {
            assert_within_default_limits(shader);
        }
    }
}

/// Offsets and names of a struct's members, and its size.
pub fn members(module: &Module, name: &str) -> Option<(Vec<(String, u32)>, u32)> {
    module.types.iter().find_map(|(_, ty)| match &ty.inner {
        TypeInner::Struct { members, span } if ty.name.as_deref() == Some(name) => {
            let list = members.iter().map(|m| (m.name.clone().unwrap_or_default(), m.offset)).collect();
            Some((list, *span))
        }
        _ => None,
    })
}

#[test]
fn structs_lie_in_wgsl_as_in_rust() {
    let clock = offset_of!(Extent, clock);
    let extent = [
        ("count", offset_of!(Extent, count)),
        ("capacity", offset_of!(Extent, capacity)),
        ("wanted", offset_of!(Extent, wanted)),
        ("step", clock + offset_of!(Clock, step)),
        ("run_step", clock + offset_of!(Clock, run_step)),
        ("seed", clock + offset_of!(Clock, seed)),
        ("given", offset_of!(Extent, given)),
        ("halted", offset_of!(Extent, halted)),
        ("before", offset_of!(Extent, before)),
        ("behind", offset_of!(Extent, behind)),
        ("made", offset_of!(Extent, made)),
        ("reserved", offset_of!(Extent, reserved)),
    ];
    let reserved = offset_of!(Status, reserved);
    let status = [
        ("fired", offset_of!(Status, fired)),
        ("too_deep", offset_of!(Status, too_deep)),
        ("retired_symbols", offset_of!(Status, retired_symbols)),
        ("needed", offset_of!(Status, needed)),
        ("needed_finished", offset_of!(Status, needed_finished)),
        ("claimed", offset_of!(Status, claimed)),
        ("reserved_0", reserved),
        ("reserved_1", reserved + 4),
    ];
    let progress = [
        ("modules", offset_of!(Progress, modules)),
        ("needed", offset_of!(Progress, needed)),
        ("capacity", offset_of!(Progress, capacity)),
        ("too_deep", offset_of!(Progress, too_deep)),
        ("steps", offset_of!(Progress, steps)),
        ("frame", offset_of!(Progress, frame)),
        ("fired", offset_of!(Progress, fired)),
        ("halted", offset_of!(Progress, halted)),
    ];
    let turns = [
        ("index", offset_of!(TurnWords, index)),
        ("growth", offset_of!(TurnWords, growth)),
        ("flags", offset_of!(TurnWords, flags)),
        ("children", offset_of!(TurnWords, children)),
    ];
    let rust = |members: &[(&str, usize)]| -> Vec<(String, u32)> {
        members.iter().map(|(name, at)| (name.to_string(), *at as u32)).collect()
    };
    let mut seen = [0, 0];
    for tuning in &TUNINGS {
        for shader in shaders(&small_plan(), tuning) {
            if let Some((list, size)) = members(&shader.module, "Extent") {
                assert_eq!((list, size as usize), (rust(&extent), size_of::<Extent>()), "{}", shader.name);
                seen[0] += 1;
            }
            if let Some((list, size)) = members(&shader.module, "Progress") {
                assert_eq!(
                    (list, size as usize),
                    (rust(&progress), size_of::<Progress>()),
                    "{}",
                    shader.name
                );
                let turn = members(&shader.module, "Turn").expect("a turn");
                assert_eq!((turn.0, turn.1 as usize), (rust(&turns), size_of::<TurnWords>()));
            }
            if let Some((list, size)) = members(&shader.module, "Status") {
                assert_eq!((list, size as usize), (rust(&status), size_of::<Status>()), "{}", shader.name);
                seen[1] += 1;
            }
        }
    }
    // All kernels have an extent; match_modules, all emits and retire a status.
    assert!(seen[0] >= 12 && seen[1] >= 6, "{seen:?}");
}

// --- files ---------------------------------------------------------------------------------------

/// What of a file stands in a linked module as it is: loops may be written out.
fn declarations(text: &str) -> impl Iterator<Item = &str> {
    text.lines()
        .filter(|line| ["fn ", "struct ", "const ", "var<"].iter().any(|start| line.starts_with(start)))
}

/// Files of `wgsl/` that are no kernels of the engine.
const NO_KERNELS: [&str; 1] = ["picture"];

#[test]
fn every_file_is_linked_by_some_kernel_and_says_what_it_is() {
    let plan = small_plan();
    let mut linked: Vec<String> = Vec::new();
    for tuning in &TUNINGS {
        linked.extend(shaders(&plan, tuning).into_iter().map(|s| s.source));
        for plan in [small_curve(), small_links()] {
            linked.extend(shaders(&plan, tuning).into_iter().map(|s| s.source));
        }
        linked.push(codegen::stencil(tuning).expect("stencil").source);
        linked.extend(codegen::measures(tuning).expect("copy and expand").map(|s| s.source));
    }
    for file in files("wgsl", "wgsl").iter().chain(&files("wgsl/shared", "wgsl")) {
        let text = read(file);
        assert!(text.starts_with("// "), "{} has no header comment", file.display());
        let used = linked.iter().any(|source| declarations(&text).all(|line| source.contains(line)));
        assert!(used || NO_KERNELS.contains(&stem(file).as_str()), "no kernel links {}", file.display());
    }
}

#[test]
fn every_kernel_has_a_twin_on_the_cpu() {
    let kernels: Vec<PathBuf> =
        files("wgsl", "wgsl").into_iter().filter(|f| !NO_KERNELS.contains(&stem(f).as_str())).collect();
    for kernel in &kernels {
        // emit_by_point is emit by another mapping: the twin is that of the entry point.
        let name = stem(kernel);
        let entry = name.split("_by_").next().unwrap_or(&name);
        assert!(read(kernel).contains(&format!("fn {entry}(")), "{name}.wgsl has no `{entry}`");
        // On the host it is the loop of the derivation itself.
        if ["proceed", "start_word"].contains(&name.as_str()) {
            continue;
        }
        let twin = read(Path::new(&format!("src/cpu/{entry}.rs")));
        assert!(twin.contains(&format!("pub fn {entry}(")), "src/cpu/{entry}.rs has no `{entry}`");
    }
    for kernel in Pass::ALL.map(|pass| pass.row().kernel) {
        assert!(kernels.iter().any(|k| stem(k) == kernel), "{kernel} has no kernel");
    }
}

// --- errors --------------------------------------------------------------------------------------

/// What codegen says of the small system with a text replaced.
#[track_caller]
fn broken(edit: Edit) -> codegen::Error {
    let plan = small_plan();
    let tuning = Tuning { mapping: Mapping::NetPerInvocation, ..Tuning::GPU };
    let refused = plan.stages().into_iter().find_map(|id| {
        let works = &mut id.of(&plan).program.works();
        works.find_map(|work| codegen::kernel(&plan, id, work, &tuning, Some(&edit)).err())
    });
    refused.unwrap_or_else(|| panic!("{edit:?} is accepted"))
}

/// The line, from 1, of a file where a text stands first.
fn line_of(file: &str, text: &str) -> usize {
    let whole = read(Path::new(file));
    whole.lines().position(|line| line.contains(text)).unwrap_or_else(|| panic!("{file} has no `{text}`")) + 1
}

#[test]
fn an_error_in_a_file_names_the_file_and_the_line() {
    // Found by the parser, in a kernel and in a file that it imports; then by the validator.
    for (file, path, find, replace) in [
        ("count", "wgsl/count.wgsl", "let i = linear(id, groups);", "let i = linear(id groups);"),
        ("extent", "wgsl/shared/extent.wgsl", "needed_finished: atomic<u32>", "needed_finished: atom<u32>"),
        ("rows", "wgsl/shared/rows.wgsl", "var line = row;", "var line = rows;"),
        (
            "compositions",
            "wgsl/shared/compositions.wgsl",
            "let each = (tiles + WORKGROUP - 1u) / WORKGROUP;",
            "let each = (tiles + WORKGROUP - 1i) / WORKGROUP;",
        ),
        (
            "retire",
            "wgsl/retire.wgsl",
            "atomicMax(&status.needed_finished, k + 1u);",
            "atomicMax(&status.needed_finished, 1.0);",
        ),
    ] {
        let error = broken(Edit { file, find, replace });
        assert_eq!(error.place, format!("{path}:{}", line_of(path, find)), "{error}");
        assert_eq!(error.rule, None, "{error}");
    }
}

#[test]
fn a_missing_import_is_refused_where_it_stands() {
    let error = broken(Edit { file: "count", find: "import rules;", replace: "import rule_table;" });
    let line = line_of("wgsl/count.wgsl", "import rules;");
    assert_eq!((error.kernel, error.place), ("count", format!("wgsl/count.wgsl:{line}")));
}

/// The source text of a rule of the small system.
fn text_of(span: Option<Span>) -> &'static str {
    span.map_or("no rule", |span| &SMALL[span.start as usize..span.end as usize])
}

#[test]
fn an_error_in_generated_code_names_the_rule() {
    // A guard, a successor's parameter, and one that only the validator finds.
    for (find, replace, rule) in [
        ("5i", "5j", "P(n, k) : n > 5 -> eps"),
        ("int_div(", "quotient(", "P(n, k) : n < 3"),
        ("select(0u, 1u, (!", "select(0u, 1i, (!", "P(n, k) : n < 3"),
        ("> 5i", "> 5u", "P(n, k) : n > 5 -> eps"),
    ] {
        let error = broken(Edit { file: GENERATED, find, replace });
        assert!(text_of(error.rule).starts_with(rule), "{error}: {:?}", text_of(error.rule));
        assert!(error.place.starts_with("generated line "), "{error}");
        assert!(!error.message.is_empty());
    }
}
