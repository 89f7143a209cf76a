
/* Sums of made-up inputs: leaves of trees hide small differences of features. */
static int probe_differs(void)
{
    sp_real in[@INPUTS@];
    sp_real sums[@OUTPUTS@];
    for (uint32_t k = 0; k < @INPUTS@; k++) {
        in[k] = (sp_real)(37 * k % 101) / (sp_real)128;
    }
    @CALL@
    for (uint32_t i = 0; i < @OUTPUTS@; i++) {
        if (to_bits(sums[i]) != golden_probe[i]) {
            return 1;
        }
    }
    return 0;
}
