// Workgroups of an indirect dispatch: more than fit in one dimension go on in the second.

const ALONG_X = 32768u;

fn workgroups(invocations: u32, workgroup: u32) -> vec3u {
  let groups = (invocations + workgroup - 1u) / workgroup;
  return vec3u(min(groups, ALONG_X), (groups + ALONG_X - 1u) / ALONG_X, 1u);
}
