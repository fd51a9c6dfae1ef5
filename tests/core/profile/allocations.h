#pragma once
// Allocations of this test program so far, counted by a replaced operator new (allocations.cpp).

namespace seamwright::testing {
long allocations();
}
