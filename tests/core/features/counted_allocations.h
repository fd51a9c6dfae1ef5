#pragma once
// Counts every allocation of the program. In a translation unit of its own: seen together with their callers,
// compilers take replaced operators for mismatched ones.

namespace seamwright::test {
long allocations();
}
