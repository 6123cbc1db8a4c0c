// SPDX-License-Identifier: MIT
// Names of FCLIB's local layout, in one place for reader and writer.
#pragma once

namespace souple::fclib {

inline constexpr const char* local = "fclib_local";
inline constexpr const char* global = "fclib_global";
inline constexpr const char* rolling = "fclib_global_rolling";
inline constexpr const char* spacedim = "spacedim";  // 2 or 3
inline constexpr const char* info = "info";
inline constexpr const char* title = "title";
inline constexpr const char* description = "description";
inline constexpr const char* math_info = "math_info";
inline constexpr const char* vectors = "vectors";
inline constexpr const char* q = "q";
inline constexpr const char* mu = "mu";
inline constexpr const char* s = "s";  // of equality constraints, with the matrices V and R
inline constexpr const char* constraint_v = "V";
inline constexpr const char* constraint_r = "R";
inline constexpr const char* solution = "solution";
inline constexpr const char* guesses = "guesses";
inline constexpr const char* guess_count = "number_of_guesses";
inline constexpr const char* u = "u";
inline constexpr const char* r = "r";

// Matrix W: m x n; nz >= 0: triplets, -1: compressed columns, -2: compressed rows.
inline constexpr const char* matrix_group = "W";
inline constexpr const char* nzmax = "nzmax";
inline constexpr const char* m = "m";
inline constexpr const char* n = "n";
inline constexpr const char* nz = "nz";
inline constexpr const char* p = "p";
inline constexpr const char* i = "i";
inline constexpr const char* x = "x";
inline constexpr int compressed_columns = -1;
inline constexpr int compressed_rows = -2;

}  // namespace souple::fclib
