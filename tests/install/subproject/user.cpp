#include "weft/weft.h"

int main() { weft::World().step(1.0 / 60); }
