/* Part of block.c: the one function of numba's runtime that a step may need. */

/* Strides of a view of new dimensions on the same numbers; 0 where there is none. Only rows that
 * lie one after the other are viewed in another shape, as in the slices of flat arrays. */
int32_t block_reshape(int64_t n, const int64_t *dimensions, const int64_t *strides, int64_t n_new,
                      const int64_t *new_dimensions, int64_t *new_strides, int64_t item_size,
                      int32_t columns_first) {
    int64_t expected = item_size, stride = item_size, count = 1;
    for (int64_t i = 0; i < n; i++) {
        count *= dimensions[i];
    }
    if (columns_first) {
        return 0;
    }
    for (int64_t i = n - 1; count > 0 && i >= 0; i--) {
        if (dimensions[i] != 1 && strides[i] != expected) {
            return 0;
        }
        expected *= dimensions[i];
    }
    for (int64_t i = n_new - 1; i >= 0; i--) {
        new_strides[i] = stride;
        stride *= new_dimensions[i];
    }
    return 1;
}
