#include <gtest/gtest.h>

#include "tests/projects/kill_test.h"

namespace seamwright {

TEST(KillLong, TwoHundredKills) {
    kill_while_appending(200, 2);
}

}  // namespace seamwright
