/** Delaunay triangulation of points (Bowyer 1981, Watson 1981). */

/** Triangles [[a, b, c], ...] of indices of points [x, y]. */
export function triangulate(points) {
  const corners = [...points, ...surround(points)];
  const count = points.length;
  let triangles = [describe(corners, count, count + 1, count + 2)];
  points.forEach((_, at) => {
    triangles = insert(corners, triangles, at);
  });
  return triangles
    .map(({ vertices }) => vertices)
    .filter((vertices) => vertices.every((vertex) => vertex < count));
}

/** A triangle around all points, so far away that it does not touch their hull. */
function surround(points) {
  const [x, y] = [0, 1].map((axis) => points.map((point) => point[axis]));
  const side = Math.max(Math.max(...x) - Math.min(...x), Math.max(...y) - Math.min(...y), 1);
  const [middle, centre] = [Math.min(...x) + side / 2, Math.min(...y) + side / 2];
  const far = 1e4 * side;
  return [[middle - far, centre - far], [middle + far, centre - far], [middle, centre + far]];
}

/** Replace the triangles whose circumcircle holds a point by those of the hole's edges with it. */
function insert(corners, triangles, at) {
  const [x, y] = corners[at];
  const kept = [];
  const edges = new Map();
  for (const triangle of triangles) {
    if ((x - triangle.x) ** 2 + (y - triangle.y) ** 2 >= triangle.square) {
      kept.push(triangle);
      continue;
    }
    triangle.vertices.forEach((from, side) => addEdge(edges, from, triangle.vertices[(side + 1) % 3]));
  }
  for (const [from, to] of edges.values()) kept.push(describe(corners, from, to, at));
  return kept;
}

/** Keep the edges that only one triangle of the hole has. */
function addEdge(edges, from, to) {
  const key = from < to ? `${from} ${to}` : `${to} ${from}`;
  if (!edges.delete(key)) edges.set(key, [from, to]);
}

/** A triangle with its circumcircle. */
function describe(corners, ...vertices) {
  const [a, b, c] = vertices.map((vertex) => corners[vertex]);
  const [bx, by, cx, cy] = [b[0] - a[0], b[1] - a[1], c[0] - a[0], c[1] - a[1]];
  const area = 2 * (bx * cy - by * cx);
  const [b2, c2] = [bx * bx + by * by, cx * cx + cy * cy];
  const x = (cy * b2 - by * c2) / area;
  const y = (bx * c2 - cx * b2) / area;
  return { vertices, x: a[0] + x, y: a[1] + y, square: x * x + y * y };
}
