#pragma once

#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "support/meshes.hpp"

namespace pliant::testing {

/// A mesh that is hard to solve on, with a force that reaches it.
struct AwkwardMesh {
  std::string name;
  Mesh mesh;
  Vector3d center = {0, 0, 0};
  double radius = 0.4;
  std::optional<double> weld = {};  ///< if it is not that of most meshes
};

using Faces = std::vector<std::vector<int>>;
using Places = std::vector<Vector3d>;

inline Places places_of(const Mesh& mesh) {
  Places places;
  for (Eigen::Index k = 0; k < mesh.positions.rows(); ++k) {
    places.push_back(mesh.positions.row(k).transpose());
  }
  return places;
}

inline Faces faces_of(const Mesh& mesh) {
  Faces faces;
  std::size_t first = 0;
  for (const int size : mesh.face_sizes) {
    const auto begin = mesh.corner_vertices.begin() + static_cast<std::ptrdiff_t>(first);
    faces.emplace_back(begin, begin + size);
    first += static_cast<std::size_t>(size);
  }
  return faces;
}

/// Two meshes as one.
inline Mesh joined(const Mesh& a, const Mesh& b) {
  Places places = places_of(a);
  Faces faces = faces_of(a);
  for (const Vector3d& place : places_of(b)) places.push_back(place);
  for (std::vector<int> face : faces_of(b)) {
    for (int& vertex : face) vertex += a.vertex_count();
    faces.push_back(face);
  }
  return mesh_of(places, faces);
}

inline Mesh moved(Mesh mesh, const Vector3d& way, double scale = 1) {
  for (Eigen::Index k = 0; k < mesh.positions.rows(); ++k) {
    mesh.positions.row(k) = scale * mesh.positions.row(k) + way.transpose();
  }
  return mesh;
}

/// A flat star of `count` spikes.
inline Mesh star(int count, double inner) {
  Places places;
  std::vector<int> face;
  for (int k = 0; k < 2 * count; ++k) {
    const double angle = std::numbers::pi * k / count, r = k % 2 == 0 ? 0.5 : inner;
    places.push_back({r * std::cos(angle), 0, -r * std::sin(angle)});
    face.push_back(k);
  }
  return mesh_of(places, {face});
}

/// A band of `count` quads round a circle, twisted by `half_turns`.
inline Mesh band(int count, int half_turns, int across = 4) {
  Places places;
  Faces faces;
  for (int k = 0; k < count; ++k) {
    const double angle = 2 * std::numbers::pi * k / count, twist = 0.5 * half_turns * angle;
    for (int n = 0; n <= across; ++n) {
      const double side = 0.3 * (2.0 * n / across - 1), r = 0.6 + side * std::cos(twist);
      places.push_back({r * std::cos(angle), side * std::sin(twist), r * std::sin(angle)});
    }
  }
  const int row = across + 1;
  for (int k = 0; k < count; ++k) {
    for (int n = 0; n < across; ++n) {
      const auto at = [&](int step, int place) {
        const bool is_turned = k + step == count && half_turns % 2 == 1;
        return (k + step) % count * row + (is_turned ? across - place : place);
      };
      faces.push_back({at(0, n), at(1, n), at(1, n + 1), at(0, n + 1)});
    }
  }
  return mesh_of(places, faces);
}

/// The meshes of this file.
inline std::vector<AwkwardMesh> awkward_meshes() {
  std::vector<AwkwardMesh> all;
  const auto add = [&](std::string name, Mesh mesh, const Vector3d& center = {0.05, 0, 0.02},
                       double radius = 0.4) {
    all.push_back({std::move(name), std::move(mesh), center, radius});
  };
  const Mesh plain = square(10, 1, 0.2), quads = square(10, 1, 0.2, true);
  const Places places = places_of(plain);
  const Faces faces = faces_of(plain);
  std::mt19937 random(11);
  const auto changed = [&](const auto& change) {
    Places own = places;
    Faces its = faces;
    change(own, its);
    return mesh_of(own, its);
  };

  for (const double height : {1e-4, 1e-8, 1e-12, 0.0}) {
    add("slivers of height " + std::to_string(height), changed([&](Places& p, Faces& f) {
          // A vertex beside the middle of every third edge between two triangles.
          for (std::size_t k = 0; k < faces.size(); k += 3) {
            const int a = f[k][0], b = f[k][1], c = f[k][2];
            p.push_back(0.5 * (p[a] + p[b]) + height * (p[c] - p[a]));
            const int middle = static_cast<int>(p.size()) - 1;
            f[k] = {a, b, middle};
            f.push_back({b, c, middle});
            f.push_back({c, a, middle});
          }
        }));
  }
  add("T-junctions", changed([&](Places& p, Faces& f) {
        // One side of an edge is divided, the other is not.
        for (std::size_t k = 0; k < 60; k += 7) {
          const int a = f[k][0], b = f[k][1], c = f[k][2];
          p.push_back(0.5 * (p[a] + p[b]));
          const int middle = static_cast<int>(p.size()) - 1;
          f[k] = {a, middle, c};
          f.push_back({middle, b, c});
        }
      }));
  add("duplicate faces", changed([&](Places&, Faces& f) {
        for (std::size_t k = 0; k < 50; ++k) f.push_back({f[k][1], f[k][2], f[k][0]});
      }));
  add("duplicate faces, flipped", changed([&](Places&, Faces& f) {
        for (std::size_t k = 0; k < 50; ++k) f.push_back({f[k][1], f[k][0], f[k][2]});
      }));
  add("flipped faces", changed([&](Places&, Faces& f) {
        for (std::size_t k = 0; k < f.size(); k += 3) std::swap(f[k][0], f[k][1]);
      }));
  add("every face flipped", changed([&](Places&, Faces& f) {
        for (auto& face : f) std::swap(face[0], face[1]);
      }));
  add("a fin on an edge", changed([&](Places& p, Faces& f) {
        p.push_back({0.05, 0.3, 0.02});
        f.push_back({f[100][0], f[100][1], static_cast<int>(p.size()) - 1});
      }));
  add("three sheets along a line", joined(joined(plain, moved(square(10, 1, 0), {0, 0, 0})),
                                          moved(square(10, 1, 0), {0, 0, 0})));
  add("two cones that meet in a point",
      joined(moved(star(7, 0.5), {0, 0, 0}), changed([&](Places& p, Faces&) {
               for (Vector3d& place : p) place.y() = 0.8 * std::hypot(place.x(), place.z());
             })));
  add("a bow tie",
      mesh_of({{0, 0, 0}, {0.3, 0, 0.2}, {0.3, 0, -0.2}, {-0.3, 0, 0.2}, {-0.3, 0, -0.2}},
              {{0, 1, 2}, {0, 4, 3}}),
      {0, 0, 0}, 0.2);
  add("a self-crossing quad",
      mesh_of({{-0.3, 0, -0.3}, {0.3, 0, -0.3}, {-0.3, 0, 0.3}, {0.3, 0, 0.3}}, {{0, 1, 2, 3}}),
      {0, 0, 0}, 0.35);
  add("isolated vertices", changed([&](Places& p, Faces&) {
        for (int k = 0; k < 20; ++k) p.push_back({0.01 * k, 0, 0.3});
        p.push_back({1e30, 0, 0});
      }));
  add("holes", changed([&](Places&, Faces& f) {
        for (std::size_t k = f.size(); k-- > 0;) {
          if (random() % 5 == 0) f.erase(f.begin() + static_cast<std::ptrdiff_t>(k));
        }
      }));
  add("only every other face", changed([&](Places&, Faces& f) {
        for (std::size_t k = f.size(); k-- > 0;) {
          if (k % 2 == 0) f.erase(f.begin() + static_cast<std::ptrdiff_t>(k));
        }
      }));
  add("a Möbius strip", band(40, 1), {0.6, 0, 0}, 0.35);
  add("a Möbius strip of three half turns", band(60, 3), {0.6, 0, 0}, 0.35);
  add("a ring pressed all round", band(40, 0), {0, 0, 0}, 0.8);
  add("scales of 1 to a million", changed([&](Places& p, Faces&) {
        for (Vector3d& place : p) {
          const double r = std::hypot(place.x(), place.z());
          place *= r > 0 ? std::pow(2 * r, 8) / (2 * r) : 1;  // spacings from 1e-7 to 1
        }
      }),
      {0.2, 0, 0.1}, 0.25);
  all.back().weld = 0;  // its smallest triangles would be one node
  add("long thin triangles", changed([&](Places& p, Faces&) {
        for (Vector3d& place : p) place.x() *= 1e-3;
      }));
  add("triangles of 1 to 1000 across", changed([&](Places& p, Faces&) {
        for (Vector3d& place : p) place.x() *= 1e3;
      }),
      {0.05, 0, 0.02}, 200);
  add("coordinates around a million", moved(plain, {1e6, -2e6, 3e6}),
      {1e6 + 0.05, -2e6, 3e6 + 0.02});
  add("a tiny mesh", moved(plain, {0, 0, 0}, 1e-9), {0, 0, 0}, 0.4e-9);
  add("a huge mesh", moved(plain, {0, 0, 0}, 1e9), {0, 0, 0}, 0.4e9);
  add("one triangle", mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}, {{0, 1, 2}}), {0.3, 0, 0.3}, 0.3);
  add("one quad", mesh_of({{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}, {{0, 1, 2, 3}}),
      {0.5, 0, 0.5}, 0.3);
  add("one n-gon of 200 corners", star(100, 0.45), {0, 0, 0}, 0.3);
  add(
      "a fan of 200 triangles",
      [] {
        Places p = {{0, 0, 0}};
        Faces f;
        for (int k = 0; k < 200; ++k) {
          p.push_back({0.5 * std::cos(k * std::numbers::pi / 100), 0,
                       -0.5 * std::sin(k * std::numbers::pi / 100)});
          f.push_back({0, k + 1, (k + 1) % 200 + 1});
        }
        return mesh_of(p, f);
      }(),
      {0, 0, 0}, 0.3);
  add("a star", star(9, 0.15), {0, 0, 0}, 0.3);
  add("a tetrahedron",
      mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
              {{0, 2, 1}, {0, 3, 2}, {0, 1, 3}, {1, 2, 3}}),
      {0, 0, 0}, 0.7);
  add("two pieces that touch", joined(plain, moved(plain, {1, 0, 0})), {0.5, 0, 0}, 0.4);
  add("two pieces that nearly touch", joined(plain, moved(plain, {1 + 1e-5, 0, 0})), {0.5, 0, 0},
      0.4);
  add("two sheets in one place", joined(plain, plain));
  add("two sheets a hair apart", joined(plain, moved(plain, {0, 1e-4, 0})));
  add("only quads", quads);
  add("concave quads", [&] {
    Places p = places_of(quads);
    for (int j = 1; j < 10; ++j) {
      for (int i = 1; i < 10; ++i) {
        if ((i + j) % 2 == 0) p[j * 11 + i] += Vector3d(0.06, 0, 0.06);
      }
    }
    return mesh_of(p, faces_of(quads));
  }());
  add("quads that are not flat", [&] {
    Places p = places_of(quads);
    for (Vector3d& place : p) place.y() = 0.1 * std::sin(31 * place.x()) * std::cos(27 * place.z());
    return mesh_of(p, faces_of(quads));
  }());
  add("a sharp crease", changed([&](Places& p, Faces&) {
        for (Vector3d& place : p) place.y() = 2 * std::abs(place.x());
      }));
  add("crumpled", changed([&](Places& p, Faces&) {
        for (Vector3d& place : p)
          place.y() = 0.1 * (static_cast<double>(random() % 1000) / 500 - 1);
      }));
  add(
      "a sphere with two poles",
      [] {
        Places p = {{0, 1, 0}};
        Faces f;
        const int around = 24, down = 12;
        for (int j = 1; j < down; ++j) {
          for (int i = 0; i < around; ++i) {
            const double t = std::numbers::pi * j / down, s = 2 * std::numbers::pi * i / around;
            p.push_back({std::sin(t) * std::cos(s), std::cos(t), std::sin(t) * std::sin(s)});
          }
        }
        p.push_back({0, -1, 0});
        for (int i = 0; i < around; ++i) {
          const int next = (i + 1) % around, last = 1 + (down - 2) * around;
          f.push_back({0, 1 + next, 1 + i});
          for (int j = 0; j < down - 2; ++j) {
            const int a = 1 + j * around + i, b = 1 + j * around + next;
            f.push_back({a, b, b + around, a + around});
          }
          f.push_back({static_cast<int>(p.size()) - 1, last + i, last + next});
        }
        return mesh_of(p, f);
      }(),
      {0, 1, 0}, 0.8);
  add(
      "a pole of quads without an edge",
      [] {
        // The first row of a grid of quads is one place.
        Places p;
        Faces f;
        const int around = 16, down = 8;
        for (int j = 0; j <= down; ++j) {
          for (int i = 0; i <= around; ++i) {
            const double r = 0.5 * j / down, s = 2 * std::numbers::pi * (i % around) / around;
            p.push_back({r * std::cos(s), 0.2 * r * r, -r * std::sin(s)});
          }
        }
        for (int j = 0; j < down; ++j) {
          for (int i = 0; i < around; ++i) {
            const int a = j * (around + 1) + i;
            f.push_back({a, a + around + 1, a + around + 2, a + 1});
          }
        }
        return mesh_of(p, f);
      }(),
      {0, 0, 0}, 0.35);
  add("a region that swallows a whole piece",
      joined(plain, moved(sphere(1), {0.1, 0.2, 0.05}, 0.05)), {0.05, 0, 0.02}, 0.42);
  add("a region that swallows all", sphere(2), {0, 0, 0}, 3);
  add("a rim through vertices exactly", square(10, 1, 0), {0, 0, 0}, 0.3);
  add("a rim through centres exactly", square(10, 1, 0, true), {0.05, 0, 0.05}, 0.3);
  add("a sphere between the vertices", square(4, 1, 0), {0.125, 0, 0.1}, 0.05);
  return all;
}

}  // namespace pliant::testing
