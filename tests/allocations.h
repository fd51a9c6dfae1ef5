#pragma once
// How often the test program has called operator new so far, in any thread. A program that links
// test_allocations has operator new and delete replaced (allocations.cpp).

namespace seamwright {
long allocations_so_far();
}  // namespace seamwright
