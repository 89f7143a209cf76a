int sp_run(sp_state *state, uint32_t n, const sp_real *position_m, const sp_real *velocity_mps,
           sp_real *force_n)
{
    if (state == NULL || position_m == NULL || force_n == NULL@NULLS@) {
        return SP_ERROR_NULL;
    }
@UNUSED@    int notes = 0;
    for (uint32_t i = 0; i < n; i++) {
        notes |= sp_step(state, position_m[i], @VELOCITY@, &force_n[i]);
    }
    return notes;
}

int sp_idle(sp_state *state, sp_real dt_s, sp_real *force_n)
{
    if (state == NULL || force_n == NULL) {
        return SP_ERROR_NULL;
    }
    if (state->begun != SP_GUARD_BEGUN) {
        return SP_ERROR_STATE;
    }
    if (!sp_is_time(dt_s)) {
        return SP_ERROR_TIME_STEP;
    }
    return hold(state, dt_s, (sp_real)1, force_n);
}

void sp_init(sp_state *state)
{
    if (state != NULL) {
        (void)memset(state, 0, sizeof *state);
        state->begun = SP_GUARD_BEGUN;
@INIT@    }
}

void sp_reset(sp_state *state)
{
@KEPT@    sp_init(state);
@AGAIN@}

uint32_t sp_abi_version(void)
{
    return @ABI@;
}

uint32_t sp_state_size(void)
{
    return (uint32_t)sizeof(sp_state);
}

const char *sp_manifest(void)
{
    return "@MANIFEST@";
}
