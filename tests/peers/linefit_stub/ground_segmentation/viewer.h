// Stands in for linefit's window, which nobody looks at here and which needs VTK.
#pragma once
#include <list>
#include <memory>
#include <utility>
#include "ground_segmentation/typedefs.h"
// Its sources ask boost for pointers that newer versions of PCL take from the standard library.
namespace boost {
using std::make_shared;
}
struct Viewer {
    template <class... Anything>
    void visualize(Anything&&...) {}
};
