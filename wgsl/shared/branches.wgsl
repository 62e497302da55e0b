// Walking the links of a word: plan/links.rs.

import links;
import ignored;
import searches;

fn found(link: u32) -> u32 {
  if (link & SETTLED) == 0u || (link & TARGET) == TARGET {
    return NOWHERE;
  }
  return link & TARGET;
}

fn up_of(i: u32) -> u32 {
  if i >= extent.count {
    return NOWHERE;
  }
  return found(links[UP * extent.count + i]);
}

fn down_of(i: u32) -> u32 {
  if i >= extent.count {
    return NOWHERE;
  }
  return found(links[DOWN * extent.count + i]);
}

// The module before in memory, if it is of the same word.
fn previous(i: u32) -> u32 {
  if i == 0u || (WORD != 0u && word_at(i - 1u, WORD) != word_at(i, WORD)) {
    return NOWHERE;
  }
  return i - 1u;
}

// The first module of a module's word: words stand one after the other.
fn first_of(i: u32) -> u32 {
  if WORD == 0u {
    return 0u;
  }
  let word = word_at(i, WORD);
  var low = 0u;
  var high = i;
  while low < high {
    let middle = low + (high - low) / 2u;
    if word_at(middle, WORD) < word {
      low = middle + 1u;
    } else {
      high = middle;
    }
  }
  return low;
}

// Behind all that hangs on a module.
fn end_of(i: u32) -> u32 {
  if i >= extent.count {
    return 0u;
  }
  return (links[LAST * extent.count + i] & TARGET) + 1u;
}

// The module so many places behind, if each hangs on the one before and begins no branch.
fn beside(i: u32, places: u32) -> u32 {
  for (var n = 1u; n <= places; n++) {
    if link_at(i + n) != i + n - 1u {
      return NOWHERE;
    }
  }
  return i + places;
}

// Whether a branch begins on the way from a module to one that it hangs on.
fn branches_off(first: u32, base: u32) -> bool {
  var i = first;
  while i != base && i != NONE {
    let link = link_at(i);
    if (link & LATERAL) != 0u {
      return true;
    }
    i = link & NONE;
  }
  return false;
}

// The first module of the next branch at `at`, behind the one that begins with `after`. What hangs on an ignored module
// counts as hanging on what that hangs on.
fn next_branch(at: u32, after: u32) -> u32 {
  let end = end_of(at);
  var i = at + 1u;
  if after != NOWHERE {
    i = end_of(after);
  }
  while i < end {
    if ignored(symbol_at(i)) {
      i += 1u;
    } else if branches_off(i, at) {
      return i;
    } else {
      i = end_of(i);
    }
  }
  return NOWHERE;
}
