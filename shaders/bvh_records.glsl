// Records of bvh.h, read as texels.
BvhNode bvh_node(uint i) {
  uvec4 a = texelFetch(bvh_nodes, int(4u * i));
  uvec4 b = texelFetch(bvh_nodes, int(4u * i + 1u));
  uvec4 c = texelFetch(bvh_nodes, int(4u * i + 2u));
  uvec4 d = texelFetch(bvh_nodes, int(4u * i + 3u));
  BvhNode n;
  n.low0 = uintBitsToFloat(a.xyz);
  n.child0 = a.w;
  n.high0 = uintBitsToFloat(b.xyz);
  n.child1 = b.w;
  n.low1 = uintBitsToFloat(c.xyz);
  n.extent = uintBitsToFloat(c.w);
  n.high1 = uintBitsToFloat(d.xyz);
  n.pad = d.w;
  return n;
}
float bvh_extent() {
  return uintBitsToFloat(texelFetch(bvh_nodes, 2).w);
}
BvhTriangle bvh_triangle(uint i) {
  uvec4 a = texelFetch(bvh_triangles, int(3u * i));
  uvec4 b = texelFetch(bvh_triangles, int(3u * i + 1u));
  uvec4 c = texelFetch(bvh_triangles, int(3u * i + 2u));
  BvhTriangle t;
  t.p0 = uintBitsToFloat(a.xyz);
  t.triangle = a.w;
  t.p1 = uintBitsToFloat(b.xyz);
  t.stops = b.w;
  t.p2 = uintBitsToFloat(c.xyz);
  t.pad = c.w;
  return t;
}
