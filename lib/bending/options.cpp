// options.cpp: names of the methods.
#include "bending/options.h"

namespace kiln::bending {

std::string name_of(Method method) { return method == Method::motion ? "dynamic" : "static"; }

}  // namespace kiln::bending
