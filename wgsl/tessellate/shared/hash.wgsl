// The slots of the table of a word's leaves: tessellate/word.rs. In front of them stand the number of shapes, the
// mask of the slots, and the shapes.

const SHAPES = LEVELS * LEVELS;
const SLOTS = 2u + SHAPES;

fn hash(root: u32, shape: u32, i: u32, j: u32) -> u32 {
  var h = root * 0x9e3779b1u + shape * 0x27d4eb2fu + i * 0x85ebca77u + j * 0xc2b2ae3du;
  h ^= h >> 15u;
  h *= 0x2c1b3c6du;
  return h ^ (h >> 13u);
}
