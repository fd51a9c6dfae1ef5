#pragma once
// What is typed into a field counts when the field is left: so it is left before a key takes what the fields hold.

#include <QWidget>

namespace seamwright {

// The field within `whole` that has the focus, as if it were left for a moment. False: what it holds is refused there, or what
// a field of the same form does; it stays, has the focus and is scrolled to.
bool leave_field(QWidget& whole);

// An editor within `whole` that holds what it has refused, wherever the focus is; what `whole` hides of itself left out.
// `settings`: of devices too, which count with the next connecting. nullptr: none.
QWidget* refused_field(QWidget& whole, bool settings = true);

}  // namespace seamwright
