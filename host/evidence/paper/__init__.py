"""The paper's protocol, tables, figures and claims."""
