/* places.h - numbers of a model that vary: places of a table, which what is written has as model->k. Where they stand in the
   library's own struct is found by letting it compute with numbers that remember: what is one then varies. */
#ifndef TRACE_PLACES_H
#define TRACE_PLACES_H
#include "steps.h"

namespace trace
{

/* Where the numbers of the table stand in the memory of a model. */
struct places {
  std::vector<std::vector<std::size_t>> offset;

  /* All that depend on inputs, each number once. */
  void find(const void *memory, std::size_t size)
  {
    std::map<int, std::size_t> known;
    for (std::size_t at = 0; at + sizeof(number) <= size; at += sizeof(number)) {
      number x;
      std::memcpy(&x, (const char *)memory + at, sizeof x);
      if (node_of(x) > 0) {
        const auto found = known.insert({node_of(x), offset.size()});
        offset.resize(offset.size() + found.second);
        offset[found.first->second].push_back(at);
      }
    }
  }

  static number *in(void *memory, std::size_t at)
  {
    return (number *)((char *)memory + at);
  }

  /* The table of a subject whose model stands there. */
  void bind(subject &s, void *memory) const
  {
    for (const auto &list : offset) {
      s.model.push_back({});
      for (std::size_t at : list) {
        s.model.back().push_back(in(memory, at));
      }
    }
  }
};

/* A body by factors, whose numbers are the results: reduce --vary. */
struct scaling : subject {
  const fb_body given;
  fb_body body;
  fb_body_factors by;
  places table;
  std::unique_ptr<fb_body_work> work{new fb_body_work};

  scaling(const trace_choice *choice, const fb_body &of) : given(of)
  {
    static const char *const names[5] = {"stiffness", "damping", "mass", "hub_mass", "hub_inertia"};
    number *const factor[5] = {&by.stiffness, &by.damping, &by.mass, &by.hub_mass, &by.hub_inertia};
    std::memset(&by, 0, sizeof by);
    for (int i = 0; i < 10 && choice->hub && choice->vary >> 2; i++) {
      *(i == 0 ? &by.hub : i < 4 ? &by.center[i - 1] : &by.inertia[i - 4]) = choice->hub[i];
    }
    for (int k = 0; k < 5; k++) {
      *factor[k] = 1.0;
      if (choice->vary >> k & 1) {
        input.push_back({names[k], factor[k]});
      }
    }
    std::vector<number> none;
    wander(1.0);
    run(*this, 0, -1, none, nullptr, KERNELS); /* leaves the body as it was recorded */
    body.recoil = body.gyration = 0.0;         /* which no step of rk4 reads */
    table.find(&body, sizeof body);
  }

  fb_status eval(int, std::vector<entry> &results) override
  {
    FBI_TRY(fb_body_scale(&body, work.get(), &given, &by));
    for (std::size_t i = 0; i < table.offset.size(); i++) {
      results.push_back({"model->k[" + std::to_string(i) + "]", places::in(&body, table.offset[i][0])});
    }
    return FB_OK;
  }

  fb_status wander(double) override
  {
    for (const entry &e : input) {
      *e.at = 1.0 + 0.3 * random();
    }
    return FB_OK;
  }

  /* Other factors, for the body of `s`. */
  fb_status give(subject &s)
  {
    FBI_TRY(wander(1.0));
    FBI_TRY(fb_body_scale(&body, work.get(), &given, &by));
    for (std::size_t i = 0; i < table.offset.size(); i++) {
      for (number *at : s.model[i]) {
        *at = *places::in(&body, table.offset[i][0]);
      }
    }
    return FB_OK;
  }
};

/* The largest eigenvalue of A x = d B x for n x n matrices one behind the other: B = L L^T, then rotations of Jacobi
   of L^-1 A L^-T. */
static const char largest_text[] =
    "static $ @_largest(const $ *pair)\n{\n"
    "  enum { n = ~ };\n"
    "  $ A[n][n], L[n][n], most = 0.0';\n"
    "  for (int i = 0; i < n; i++) {\n"
    "    for (int j = 0; j < n; j++) {\n      A[i][j] = 0.5' * (pair[i * n + j] + pair[j * n + i]);\n    }\n"
    "    for (int j = 0; j <= i; j++) {\n"
    "      $ sum = pair[n * n + i * n + j];\n"
    "      for (int k = 0; k < j; k++) {\n        sum -= L[i][k] * L[j][k];\n      }\n"
    "      L[i][j] = i == j ? sqrt'(sum) : sum / L[j][j];\n    }\n  }\n"
    "  for (int side = 0; side < 2; side++) { /* rows, then columns */\n"
    "    for (int c = 0; c < n; c++) {\n      for (int i = 0; i < n; i++) {\n"
    "        $ sum = side ? A[c][i] : A[i][c];\n"
    "        for (int k = 0; k < i; k++) {\n          sum -= L[i][k] * (side ? A[c][k] : A[k][c]);\n        }\n"
    "        *(side ? &A[c][i] : &A[i][c]) = sum / L[i][i];\n      }\n    }\n  }\n"
    "  for (int round = 0; round < 12; round++) {\n"
    "    for (int p = 0; p < n; p++) {\n      for (int q = p + 1; q < n; q++) {\n"
    "        const $ apart = 0.5' * (A[q][q] - A[p][p]), off = A[p][q], root = sqrt'(apart * apart + off * off);\n"
    "        const $ t = root > 0.0' ? off / (apart < 0.0' ? apart - root : apart + root) : 0.0';\n"
    "        const $ c = 1.0' / sqrt'(1.0' + t * t), s = t * c;\n"
    "        for (int k = 0; k < n; k++) {\n"
    "          const $ x = A[p][k], y = A[q][k];\n"
    "          A[p][k] = c * x - s * y;\n          A[q][k] = s * x + c * y;\n        }\n"
    "        for (int k = 0; k < n; k++) {\n"
    "          const $ x = A[k][p], y = A[k][q];\n"
    "          A[k][p] = c * x - s * y;\n          A[k][q] = s * x + c * y;\n        }\n"
    "      }\n    }\n  }\n"
    "  for (int a = 0; a < n; a++) {\n    most = A[a][a] > most ? A[a][a] : most;\n  }\n"
    "  return most;\n}\n\n";

} // namespace trace
#endif
