//! The checker's codes. A code never changes its meaning.
//!
//! `E02..` names, arguments and types; `E025.` on: structure; `W03..` warnings.

/// A module that is not declared.
pub const UNKNOWN_MODULE: &str = "E0201";
/// A name that has no value here.
pub const UNKNOWN_NAME: &str = "E0202";
/// A function that does not exist.
pub const UNKNOWN_FUNCTION: &str = "E0203";
/// A type that does not exist.
pub const UNKNOWN_TYPE: &str = "E0204";
/// A rule group that does not exist.
pub const UNKNOWN_GROUP: &str = "E0205";
/// A template, shape or earlier system that does not exist.
pub const UNKNOWN_TEMPLATE: &str = "E0206";
/// A slot that the template has not.
pub const UNKNOWN_SLOT: &str = "E0207";
/// A subdivision scheme that does not exist.
pub const UNKNOWN_SCHEME: &str = "E0208";
/// A query that is not declared.
pub const UNKNOWN_QUERY: &str = "E0209";
/// A placement or volume that is not declared.
pub const UNKNOWN_PLACE: &str = "E0210";
/// A transform behind `at` or `on` that does not exist.
pub const UNKNOWN_TRANSFORM: &str = "E0211";
/// A name that has a value elsewhere, but not here.
pub const NOT_HERE: &str = "E0212";
/// A word of the language used as a name.
pub const RESERVED: &str = "E0213";
/// Two things of one name where only one may be.
pub const DUPLICATE: &str = "E0214";
/// A module with the wrong number of arguments.
pub const MODULE_ARITY: &str = "E0215";
/// A function, shape or transform with the wrong number of arguments.
pub const FUNCTION_ARITY: &str = "E0216";
/// A value of another type than is needed.
pub const TYPE: &str = "E0217";
/// An operator or function that does not take values of these types.
pub const OPERANDS: &str = "E0218";
/// A component that the value has not.
pub const COMPONENT: &str = "E0219";
/// An index beyond its list, or of something that is no list.
pub const INDEX: &str = "E0220";
/// A list that is empty, mixed, or holds more than constants.
pub const LIST: &str = "E0221";
/// A vector that is none: too many components, or components that are no numbers.
pub const VECTOR: &str = "E0222";
/// A number that no type of the language holds, or a division of numerals by zero.
pub const NUMBER: &str = "E0223";
/// A value that must be known before the run and is not.
pub const NOT_CONSTANT: &str = "E0224";
/// `rand` or `randn` where nothing is drawn.
pub const RANDOM: &str = "E0225";
/// Consts that need one another.
pub const CYCLE: &str = "E0226";
/// A default outside its own range.
pub const RANGE: &str = "E0227";
/// `==` on vectors.
pub const VECTOR_EQUALITY: &str = "E0228";
/// An expression nested too deep.
pub const TOO_DEEP: &str = "E0229";

/// An attribute of a system that its kind has not, or that contradicts another.
pub const SYSTEM_ATTRIBUTE: &str = "E0250";
/// A patch system without `bezier`, or with a degree outside 1 to 8.
pub const DEGREE: &str = "E0251";
/// A declaration or step that systems of this kind have not.
pub const WRONG_KIND: &str = "E0252";
/// A successor of a patch system that is neither one block, one module nor `eps`.
pub const PATCH_SUCCESSOR: &str = "E0253";
/// A branch where none may stand.
pub const BRANCH: &str = "E0254";
/// A context in a patch or mesh system.
pub const CONTEXT: &str = "E0255";
/// A context deeper than 8.
pub const CONTEXT_DEPTH: &str = "E0256";
/// Several strict predecessors that cannot be.
pub const STRICT: &str = "E0257";
/// A weight without an alternative, an alternative without a weight, a weight that is never positive.
pub const WEIGHT: &str = "E0258";
/// A tag where none may stand, or in only one predecessor of a join.
pub const TAG: &str = "E0259";
/// A template without the base that its use needs.
pub const TEMPLATE_BASE: &str = "E0260";
/// A template with a base that is not closed.
pub const TEMPLATE_OPEN: &str = "E0261";
/// A face or crease of a template that is none.
pub const TEMPLATE_FACE: &str = "E0262";
/// A template whose base has other corners than any face that it could replace.
pub const BASE_SIZE: &str = "E0263";
/// `derive until terminal` without `max`.
pub const NO_MAX: &str = "E0264";
/// A count below zero.
pub const COUNT: &str = "E0265";
/// A second `run:`, or an item or step after the one that must be last.
pub const RUN_ORDER: &str = "E0266";
/// An axiom that systems of this kind cannot start from, or none.
pub const AXIOM: &str = "E0267";
/// More than 4,096 rules in a system.
pub const TOO_MANY_RULES: &str = "E0268";
/// `trace` into a module that holds no point, or `f` in a ring that is traced.
pub const TRACE: &str = "E0269";
/// A successor that systems of this kind have not.
pub const SUCCESSOR: &str = "E0270";
/// More than 65,534 symbols in a system.
pub const TOO_MANY_SYMBOLS: &str = "E0272";

/// A rule that is never reached.
pub const UNREACHED: &str = "W0301";
/// Coefficients of a point that do not sum to 1.
pub const AFFINE: &str = "W0302";
/// A context longer than the axiom's ring.
pub const CONTEXT_WRAPS: &str = "W0303";
/// `#` in a ring, where it never matches.
pub const END_IN_RING: &str = "W0304";
/// A division of ints that truncates.
pub const TRUNCATES: &str = "W0305";
/// A param or const that is never used.
pub const UNUSED: &str = "W0306";
/// A name that hides a param or const.
pub const HIDDEN: &str = "W0307";
/// `noise` in a condition: CPU and GPU may decide differently.
pub const NOISE: &str = "W0308";
/// A division of ints by the constant 0.
pub const DIVISION_BY_ZERO: &str = "W0309";
/// A name in a list of slots that the template has not.
pub const SLOT_IGNORED: &str = "W0310";
