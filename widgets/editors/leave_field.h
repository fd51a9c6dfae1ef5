#pragma once
// What is typed into a field counts when the field is left: so it is left before a key takes what the fields hold.

#include <QWidget>

namespace seamwright {

// The field within `whole` that has the focus, as if it were left for a moment. False: what it holds is refused there, or what
// a field of the same form does; it stays, has the focus and is scrolled to.
bool leave_field(QWidget& whole);

}  // namespace seamwright
