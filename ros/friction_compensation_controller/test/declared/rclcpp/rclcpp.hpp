#include "declared.hpp"
